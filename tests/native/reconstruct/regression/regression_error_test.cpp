// A8: the terms of the estimated error of the regression on features.
#include "reconstruct/regression/regression_error.h"

#include <gtest/gtest.h>

#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus::regression_error_test {
namespace {

constexpr int kWidth = 60, kHeight = 40;

reconstruct::Field filled(int channels, const std::function<float(int x)>& value) {
  reconstruct::Field field(kWidth, kHeight, channels);
  for_values(&field, [&](float& v, int x, int, int) { v = value(x); });
  return field;
}
reconstruct::Field constant(float value, int channels = 3) {
  return filled(channels, [=](int) { return value; });
}

const reconstruct::Field kNone = constant(0.0f), kOne = constant(1.0f), kUnbiased = constant(0.0f, 1);

// Statistical tests (A8_Error) check the factors; this test checks what they multiply.
TEST(A8_RegressionError, NoiseIsScaledByMoreThanTheWeightsShow) {
  const reconstruct::Field noise = constant(0.1f),
                           error = reconstruct::RegressionError({kOne, kNone, kOne, noise}, kUnbiased).of();
  EXPECT_GT(error.row(20)[30], 0.01);
  EXPECT_NEAR(error.row(20)[30], reconstruct::kHidden * 0.01, 1e-6);
}

// With absolute squares, the wall would have a thousand times its error within three pixels of the light.
TEST(A8_RegressionError, NoiseOfALightDoesNotAddToTheWallBesideIt) {
  const reconstruct::Field light = filled(3, [](int x) { return x < 30 ? 100.0f : 1.0f; });
  const reconstruct::Field noise = filled(3, [](int x) { return x < 30 ? 10.0f : 0.1f; });
  const reconstruct::Field error = reconstruct::RegressionError({light, kNone, light, noise}, kUnbiased).of();
  EXPECT_NEAR(error.row(20)[31], reconstruct::kHidden * 0.01, 0.1 * reconstruct::kHidden * 0.01);
  EXPECT_NEAR(error.row(20)[28], reconstruct::kHidden * 100.0, 0.1 * reconstruct::kHidden * 100.0);
}

TEST(A8_RegressionError, BiasIsAddedAndNeverSubtracted) {
  EXPECT_NEAR(reconstruct::RegressionError({kOne, kNone, kOne, kNone}, constant(0.5f, 1)).of().row(20)[30], 0.5, 1e-6);
  EXPECT_EQ(reconstruct::RegressionError({kOne, kNone, kOne, kNone}, constant(-0.5f, 1)).of().row(20)[30], 0.0f);
}

TEST(A8_RegressionError, LostLightIsEstimatedUnlessNoiseHidesIt) {
  const reconstruct::Field before = constant(1.2f);
  EXPECT_NEAR(reconstruct::RegressionError({before, kNone, kOne, kNone}, kUnbiased).of().row(20)[30],
              reconstruct::kLost * 0.04, 1e-4);
  EXPECT_EQ(reconstruct::RegressionError({before, constant(4.0f), kOne, kNone}, kUnbiased).of().row(20)[30], 0.0f);
}

// Regression: relative to the mean of 3×3 pixels, the pixel beside the highlight had a thousand times this error, and
// with it a picture without noise up to eight times its true one.
TEST(A8_RegressionError, LostLightOfAHighlightDoesNotAddToTheDeliveredErrorOfThePixelBesideIt) {
  const auto light = [](float by) { return filled(3, [=](int x) { return x == 30 ? 100.0f * by : 1.0f; }); };
  const reconstruct::Field before = light(1.2f), after = light(1.0f);
  const auto error_at = [&](int x, reconstruct::ErrorUse use) {
    return reconstruct::RegressionError({before, kNone, after, kNone}, kUnbiased).of(use).row(20)[x];
  };
  const float own = 1.0f + reconstruct::kDark, lost = 20.0f / (17.0f * (116.0f / 17.0f + reconstruct::kDark));
  EXPECT_NEAR(error_at(31, reconstruct::ErrorUse::Delivered), reconstruct::kLostDelivered * own * own * lost * lost,
              1e-4);
  EXPECT_GT(error_at(31, reconstruct::ErrorUse::Weights), 100.0f * error_at(31, reconstruct::ErrorUse::Delivered));
  EXPECT_GT(error_at(30, reconstruct::ErrorUse::Delivered), 1000.0f * error_at(31, reconstruct::ErrorUse::Delivered));
}

}  // namespace
}  // namespace gradus::regression_error_test
