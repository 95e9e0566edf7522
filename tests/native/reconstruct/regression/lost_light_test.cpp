// Restoring the light that the regression loses.
#include "reconstruct/regression/lost_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "reconstruct/field_values.h"

namespace gradus::lost_light_test {
namespace {

constexpr int kWidth = 70, kHeight = 50;  // cells at the borders are cut

reconstruct::Field constant(float value, int channels = 3) {
  reconstruct::Field field(kWidth, kHeight, channels);
  for_values(&field, [value](float& v, int, int, int) { v = value; });
  return field;
}

double sum_of(const reconstruct::Field& field) {
  double sum = 0.0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) sum += double(mean_of(field, x, y));
  }
  return sum;
}

// What the samples have more than a picture of light 1: `count` bright samples of one half, spread over the picture.
struct Sampled {
  reconstruct::Field residual = constant(0.0f), half_difference = constant(0.0f);
  Sampled(int count, float light) {
    for (int i = 0; i < count; ++i) {
      const int pixel = (2 * i + 1) * kWidth * kHeight / (2 * count);
      for (int c = 0; c < 3; ++c) {
        residual.row(pixel / kWidth, c)[pixel % kWidth] += light;
        half_difference.row(pixel / kWidth, c)[pixel % kWidth] += light;
      }
    }
  }
};

// Returns a picture of light 1 after what it has lost is restored.
reconstruct::Field restored(const Sampled& sampled, const reconstruct::Field& noise) {
  return reconstruct::restore_lost_light(constant(1.0f), noise, {{}}, {sampled.residual}, {&sampled.half_difference});
}

// One bright sample says nothing, n of them all but 1/n of their light.
TEST(B2_LostLight, IsRestoredByTheStatisticsOfBrightSamples) {
  const reconstruct::Field noise = constant(1.0f, 1);
  for (const int count : {1, 2, 10, 100}) {
    const Sampled sampled(count, 20.0f);
    const double lost = sum_of(sampled.residual), back = sum_of(restored(sampled, noise)) - sum_of(constant(1.0f));
    EXPECT_NEAR(back / lost, 1.0 - 1.0 / count, 1e-3) << count;
  }
}

// A light that is seen directly has little noise.
TEST(B2_LostLight, GoesToPlacesWithNoise) {
  reconstruct::Field noise = constant(1.0f, 1);
  for (int y = 0; y < kHeight; ++y) std::fill_n(noise.row(y), kWidth / 2, 0.0f);
  const reconstruct::Field picture = restored(Sampled(100, 10.0f), noise);
  EXPECT_EQ(picture.row(5)[5], 1.0f);
  EXPECT_GT(picture.row(5)[kWidth - 5], 1.5f);
}

// Samples of other frames that show other light count by the share that the test of light keeps.
TEST(B2_LostLight, SamplesThatAreNotKeptDoNotCount) {
  const Sampled own(100, 50.0f), other(100, 5000.0f);
  const reconstruct::Field noise = constant(1.0f, 1);
  const reconstruct::Field two =
      reconstruct::restore_lost_light(constant(1.0f), noise, {{}, constant(0.0f, 1)}, {own.residual, other.residual},
                                      {&own.half_difference, &other.half_difference});
  EXPECT_NEAR(sum_of(two), sum_of(restored(own, noise)), 1e-2);
  EXPECT_GT(sum_of(two), 1.5 * sum_of(constant(1.0f)));
}

// Where little of the picture is noisy, that part would take what all of it lacks.
TEST(B2_LostLight, FactorsAreBounded) {
  for (const float offset : {-0.02f, 0.02f}) {
    reconstruct::Field picture = constant(10.0f), noise = constant(1e-4f, 1), residual = constant(10.0f * offset);
    for (int c = 0; c < 3; ++c) std::fill_n(picture.row(9, c), kWidth, 0.01f);
    std::fill_n(noise.row(9), kWidth, 1.0f);
    const reconstruct::Field half = constant(0.0f);
    const reconstruct::Field factors = reconstruct::restore_lost_light(picture, noise, {{}}, {residual}, {&half});
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        ASSERT_GE(factors.row(y)[x], 0.5f);
        ASSERT_LE(factors.row(y)[x], 2.0f);
      }
    }
  }
}

// Where more light is missing, more is restored, without steps between cells.
TEST(B2_LostLight, ChangesSmoothlyOverThePicture) {
  constexpr int kWide = 640;
  reconstruct::Field residual(kWide, 32, 3), half(kWide, 32, 3), picture(kWide, 32, 3), noise(kWide, 32, 1);
  for_values(&residual, [](float& value, int x, int, int) { value = float(x) / kWide; });
  for_values(&picture, [](float& value, int, int, int) { value = 1.0f; });
  for_values(&noise, [](float& value, int, int, int) { value = 1.0f; });
  picture = reconstruct::restore_lost_light(picture, noise, {{}}, {residual}, {&half});
  EXPECT_LT(picture.row(0)[0], 1.3f);
  EXPECT_GT(picture.row(0)[kWide - 1], 1.7f);
  for (int x = 1; x < kWide; ++x) ASSERT_LT(std::fabs(picture.row(0)[x] - picture.row(0)[x - 1]), 0.003f) << x;
}

}  // namespace
}  // namespace gradus::lost_light_test
