// The stats object of a film.
#include "render/stats.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/path_scene.h"

namespace gradus::test {
namespace {

nlohmann::json warnings_of(const render::RenderStats& stats) {
  return nlohmann::json::parse(
      render::stats_json(stats, render::Plan{}, make_test_film(test_settings(4, 4), true)))["warnings"];
}

// Regression: only stills had this warning; frames that are reconstructed together did not.
TEST(Stats, ASolverThatStoppedAtItsLimitIsAWarning) {
  render::RenderStats stats;
  stats.warnings = {"another"};
  EXPECT_EQ(warnings_of(stats), nlohmann::json({"another"}));
  stats.solve.hit_cap = true;
  EXPECT_EQ(warnings_of(stats), nlohmann::json({"another", "the reconstruction stopped at its limit of steps"}));
}

}  // namespace
}  // namespace gradus::test
