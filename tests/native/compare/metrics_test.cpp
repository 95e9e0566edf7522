// Error metrics against values computed by hand.
#include "compare/metrics.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "base/error.h"

namespace gradus::metrics_test {
namespace {

compare::RgbImage constant(int width, int height, float value) {
  return {width, height, std::vector<float>(size_t(width) * height * 3, value)};
}

TEST(Compare, EqualImagesHaveNoError) {
  const compare::Metrics m = compare::compare_images(constant(20, 15, 0.3f), constant(20, 15, 0.3f));
  EXPECT_EQ(m.rel_mse, 0.0);
  EXPECT_EQ(m.smape, 0.0);
  EXPECT_NEAR(m.ssim, 1.0, 1e-12);
  EXPECT_NEAR(m.mean, 0.3, 1e-7);
}

TEST(Compare, ConstantsAgreeWithTheDefinitions) {
  const compare::Metrics m = compare::compare_images(constant(10, 10, 0.6f), constant(10, 10, 0.5f));
  const double d = double(0.6f) - 0.5;
  EXPECT_NEAR(m.rel_mse, d * d / (1e-3 + 0.25), 1e-9);
  EXPECT_NEAR(m.mse, d * d, 1e-9);
  EXPECT_NEAR(m.smape, d / (1.1 + 1e-3), 1e-7);
  EXPECT_NEAR(m.log_mse, std::pow(std::log(1.6 / 1.5), 2), 1e-7);
  EXPECT_NEAR(m.signed_ratio, 1.0, 1e-9);
}

TEST(Compare, RelativeErrorUsesTheGrayOfTheReference) {
  compare::RgbImage image{1, 1, {1.0f, 0.0f, 0.0f}}, reference{1, 1, {0.0f, 0.0f, 3.0f}};
  EXPECT_NEAR(compare::compare_images(image, reference).rel_mse, (1.0 + 9.0) / 3.0 / (1e-3 + 1.0), 1e-9);
}

TEST(Compare, TrimmingRemovesTheWorstPixels) {
  compare::RgbImage image = constant(100, 100, 0.5f);
  const compare::RgbImage reference = constant(100, 100, 0.5f);
  for (size_t pixel = 0; pixel < 10; ++pixel) image.pixels[3 * 997 * pixel] = 1000.0f;
  const compare::Metrics m = compare::compare_images(image, reference);
  EXPECT_GT(m.rel_mse, 100.0);
  EXPECT_NEAR(m.rel_mse_trimmed, 0.0, 1e-9);
}

TEST(Compare, NoiseIsNotBias) {
  compare::RgbImage image = constant(200, 200, 0.5f);
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0.0f, 0.1f);
  for (float& v : image.pixels) v += normal(random);
  const compare::Metrics m = compare::compare_images(image, constant(200, 200, 0.5f));
  EXPECT_LT(m.signed_ratio, 0.1);
  EXPECT_LT(m.ssim, 0.9);
  EXPECT_NEAR(m.mse, 0.01, 3e-4);
}

TEST(Compare, CountsAndSkipsValuesThatAreNotFinite) {
  compare::RgbImage image = constant(10, 10, 0.5f);
  image.pixels[7] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[50] = std::numeric_limits<float>::infinity();
  const compare::Metrics m = compare::compare_images(image, constant(10, 10, 0.5f));
  EXPECT_EQ(m.nonfinite, 2u);
  EXPECT_EQ(m.rel_mse, 0.0);
  EXPECT_TRUE(std::isfinite(m.ssim));
}

TEST(Compare, RefusesOtherSizes) {
  EXPECT_THROW(compare::compare_images(constant(2, 3, 1.0f), constant(3, 2, 1.0f)), Error);
}

}  // namespace
}  // namespace gradus::metrics_test
