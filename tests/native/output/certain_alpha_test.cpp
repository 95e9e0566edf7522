// Alpha of pixels that are surely opaque or empty.
#include "output/certain_alpha.h"

#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "reconstruct/feature_film.h"
#include "support/developed.h"

namespace gradus::certain_alpha_test {
namespace {

using namespace test;
using output::CertainAlpha;

constexpr int kWidth = 48, kHeight = 32, kEdge = 24;

// Returns a film without features that tell its pixels apart. Its left part is empty, its right part opaque; samples of
// the column between fall on either side.
film::Film half_covered() {
  const std::vector<float> grey(size_t(kWidth * kHeight * 3), 0.5f);
  film::Film film = make_feature_film(
      {kWidth, kHeight, grey, [](size_t) { return 0.1f; }, [](int, int, int, int) { return 0.5f; }}, 4);
  for (int half = 0; half < film::kHalves; ++half) {
    for (size_t i = 0; i < film.components[0].primal[half].size(); ++i) {
      const int x = int(i % kWidth);
      film.components[0].primal[half][i].w = x < kEdge || (x == kEdge && half == 0) ? 0.0f : 1.0f;
    }
  }
  return film;
}

TEST(CertainAlpha, HoldsWhereAllSamplesAroundAgree) {
  const std::vector<CertainAlpha> certain = output::find_certain_alpha(half_covered());
  for (size_t i = 0; i < certain.size(); ++i) {
    const int x = int(i % kWidth);
    ASSERT_EQ(certain[i], x < kEdge - 1   ? CertainAlpha::Empty
                          : x > kEdge + 1 ? CertainAlpha::Opaque
                                          : CertainAlpha::None)
        << x;
  }
}

TEST(CertainAlpha, IsThatOfSumsOverComponents) {
  film::Film film = half_covered();
  film.components.push_back(film.components[0]);
  for (Radiance& pixel : film.components[1].primal[0]) pixel.w = 0.25f;
  for (Radiance& pixel : film.components[1].primal[1]) pixel.w = 0.0f;
  for (const CertainAlpha& alpha : output::find_certain_alpha(film)) ASSERT_EQ(alpha, CertainAlpha::None);
  for (Radiance& pixel : film.components[1].primal[0]) pixel.w = 0.0f;
  EXPECT_EQ(output::find_certain_alpha(film), output::find_certain_alpha(half_covered()));
}

// Regression: opaque pixels were a tenth transparent where mirrors showed what lies beside them, before the sky.
TEST(CertainAlpha, IsDelivered) {
  const auto film = std::make_shared<film::Film>(half_covered());
  double changed = 0.0;
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    const std::vector<float> rgba = reconstructed(film, reconstruction, film->region);
    for (size_t i = 0; i < rgba.size() / 4; ++i) {
      const int x = int(i % kWidth);
      if (x < kEdge - 1 || x > kEdge + 1) {
        ASSERT_EQ(rgba[4 * i + 3], x < kEdge ? 0.0f : 1.0f) << x;
      }
      if (x == kEdge) changed += std::fabs(rgba[4 * i + 3] - 0.5f);
    }
  }
  EXPECT_GT(changed, 0.01 * kHeight) << "edges are regressed";
}

}  // namespace
}  // namespace gradus::certain_alpha_test
