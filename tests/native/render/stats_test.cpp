// The stats object of a film.
#include "render/stats.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/fake_integrator.h"
#include "support/path_scene.h"

namespace gradus::test::stats_test {
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

TEST(Stats, TimesAddUpToTheirTotal) {
  render::RenderStats stats;
  stats.cpu_seconds = {1.0, 2.0, 4.0, 8.0, 16.0, 32.0};
  const nlohmann::json found = nlohmann::json::parse(
      render::stats_json(stats, render::Plan{}, make_test_film(test_settings(4, 4), true)))["cpu_seconds"];
  EXPECT_EQ(found, nlohmann::json({{"sample", 1.0},
                                   {"preview", 2.0},
                                   {"reconstruct", 4.0},
                                   {"denoise", 8.0},
                                   {"correspondence", 16.0},
                                   {"store", 32.0},
                                   {"total", 63.0}}));
}

// Regression: a strict render was refused because of a warning about noise.
TEST(Stats, AStrictRenderRefusesWhatIsLeftOutAndNotWhatIsNoisy) {
  auto noisy = std::make_shared<scene::Snapshot>(*empty_snapshot());
  noisy->noise_warnings = {"noisy"};
  auto incomplete = std::make_shared<scene::Snapshot>(*noisy);
  incomplete->warnings = {"incomplete"};
  GradusSettings settings = small_settings(8, 8, 1);
  const auto warnings = [&](const auto& snapshot) {
    render::Render render(nullptr, snapshot, settings, nullptr, fake_factory());
    render.wait(-1.0);
    std::string text;
    EXPECT_EQ(render.outcome(&text), GRADUS_OK) << text;
    return nlohmann::json::parse(render.stats_json())["warnings"];
  };
  EXPECT_EQ(warnings(incomplete), nlohmann::json({"incomplete", "noisy"}));
  settings.strict = 1;
  EXPECT_EQ(warnings(noisy), nlohmann::json({"noisy"}));
  EXPECT_THROW(render::Render(nullptr, incomplete, settings, nullptr, fake_factory()), Error);
}

}  // namespace
}  // namespace gradus::test::stats_test
