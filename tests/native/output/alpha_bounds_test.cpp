// Bounds of alpha by the samples around a pixel.
#include "output/alpha_bounds.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "reconstruct/feature_film.h"
#include "reconstruct/regularized.h"
#include "support/developed.h"

namespace gradus::alpha_bounds_test {
namespace {

using namespace test;

constexpr int kWidth = 48, kHeight = 32, kEdge = 24;
constexpr float kSamples = 2.0f;  // of a pixel

// Returns a film without features that tell its pixels apart, whose samples have the alpha that is given.
film::Film film_with_alpha(const std::function<float(int x, int half)>& alpha) {
  const std::vector<float> grey(size_t(kWidth * kHeight * 3), 0.5f);
  film::Film film = make_feature_film(
      {kWidth, kHeight, grey, [](size_t) { return 0.1f; }, [](int, int, int, int) { return 0.5f; }}, 4);
  for (int half = 0; half < film::kHalves; ++half) {
    for (size_t i = 0; i < film.components[0].primal[half].size(); ++i)
      film.components[0].primal[half][i].w = alpha(int(i % kWidth), half);
  }
  return film;
}

// Returns a film whose left part is empty and whose right part is opaque; one of the samples in the column between is
// opaque.
film::Film half_covered() {
  return film_with_alpha([](int x, int half) { return x < kEdge || (x == kEdge && half == 0) ? 0.0f : 1.0f; });
}

// Returns what n samples may all miss, for the largest square that lies beside the column of the edge.
float missed_beside_edge(int x) {
  const int radius = std::min(std::abs(x - kEdge) - 1, 4), side = 2 * radius + 1;
  return radius > 0 ? std::min(3.0f / (kSamples * float(side * side)), 1.0f) : 1.0f;
}

TEST(AlphaBounds, NarrowWithTheUniformSquareAroundAPixel) {
  const std::vector<output::AlphaBounds> bounds = output::find_alpha_bounds(half_covered());
  for (size_t i = 0; i < bounds.size(); ++i) {
    const int x = int(i % kWidth);
    ASSERT_FLOAT_EQ(bounds[i].least, x > kEdge ? 1.0f - missed_beside_edge(x) : 0.0f) << x;
    ASSERT_FLOAT_EQ(bounds[i].most, x < kEdge ? missed_beside_edge(x) : 1.0f) << x;
  }
}

TEST(AlphaBounds, AreThoseOfSumsOverComponents) {
  film::Film film = half_covered();
  film.components.push_back(film.components[0]);
  for (int half = 0; half < film::kHalves; ++half) {
    for (Radiance& pixel : film.components[1].primal[half]) pixel.w = half == 0 ? 0.25f : 0.0f;
  }
  for (const output::AlphaBounds& bounds : output::find_alpha_bounds(film)) {
    ASSERT_EQ(bounds.least, 0.0f);
    ASSERT_EQ(bounds.most, 1.0f);
  }
}

// Regression: opaque pixels were a tenth transparent where mirrors showed what lies beside them, before the sky.
TEST(AlphaBounds, HoldForThePicture) {
  const auto film = std::make_shared<film::Film>(half_covered());
  const std::vector<float> rgba = reconstructed(film, GRADUS_RECONSTRUCTION_REGULARIZED, film->region),
                           unbounded = reconstruct::regularize(*film, false, never, nullptr).image;
  const std::vector<output::AlphaBounds> bounds = output::find_alpha_bounds(*film);
  float outside = 0.0f;
  for (size_t i = 0; i < bounds.size(); ++i) {
    const float alpha = rgba[4 * i + 3];
    ASSERT_GE(alpha, bounds[i].least) << i % kWidth;
    ASSERT_LE(alpha, bounds[i].most) << i % kWidth;
    outside = std::max({outside, bounds[i].least - unbounded[4 * i + 3], unbounded[4 * i + 3] - bounds[i].most});
  }
  EXPECT_GT(outside, 0.0f) << "the regression alone mixes both parts";
}

// Thin smoke covers 2 % of every pixel: most pixels have no sample of it.
TEST(AlphaBounds, KeepTheMeanOfThinThings) {
  std::mt19937 random(1);
  std::bernoulli_distribution is_hit(0.02);
  const auto film =
      std::make_shared<film::Film>(film_with_alpha([&](int, int) { return is_hit(random) ? 1.0f : 0.0f; }));
  const std::vector<float> rgba = reconstructed(film, GRADUS_RECONSTRUCTION_REGULARIZED, film->region),
                           unbounded = reconstruct::regularize(*film, false, never, nullptr).image;
  double mean = 0.0, expected = 0.0;
  for (size_t i = 3; i < rgba.size(); i += 4) {
    mean += rgba[i];
    expected += std::clamp(unbounded[i], 0.0f, 1.0f);
  }
  EXPECT_NEAR(mean, expected, 0.1 * expected);
}

}  // namespace
}  // namespace gradus::alpha_bounds_test
