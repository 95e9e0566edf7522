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

// Returns the light of samples that hold `residual` more than a picture.
reconstruct::LightOfSamples light_of(const reconstruct::Field& picture, const reconstruct::Field& residual,
                                     const reconstruct::Field& half_difference) {
  const int w = picture.width(), h = picture.height();
  reconstruct::Field light = picture;
  add(residual, &light);
  return {reconstruct::make_field(w, h, [](int, int) { return 1.0f; }), std::move(light),
          reconstruct::make_field(w, h, [&](int x, int y) { return mean_of_squares(half_difference, x, y); })};
}

// What the samples have more than a picture of light 1: `count` bright samples of one half, spread over the picture.
reconstruct::Field bright_samples(int count, float light) {
  reconstruct::Field residual = constant(0.0f);
  for (int i = 0; i < count; ++i) {
    const int pixel = (2 * i + 1) * kWidth * kHeight / (2 * count);
    for (int c = 0; c < 3; ++c) residual.row(pixel / kWidth, c)[pixel % kWidth] += light;
  }
  return residual;
}

// Returns a picture of light 1 after what it has lost is restored.
reconstruct::Field restored(const reconstruct::Field& residual, const reconstruct::Field& noise) {
  const reconstruct::Field picture = constant(1.0f);
  return reconstruct::restore_lost_light(picture, picture, noise, light_of(picture, residual, residual));
}

// One bright sample says nothing, n of them all but 1/n of their light.
TEST(B2_LostLight, IsRestoredByTheStatisticsOfBrightSamples) {
  const reconstruct::Field noise = constant(1.0f, 1);
  for (const int count : {1, 2, 10, 100}) {
    const reconstruct::Field residual = bright_samples(count, 20.0f);
    const double lost = sum_of(residual), back = sum_of(restored(residual, noise)) - sum_of(constant(1.0f));
    EXPECT_NEAR(back / lost, 1.0 - 1.0 / count, 1e-3) << count;
  }
}

// A light that is seen directly has little noise.
TEST(B2_LostLight, GoesToPlacesWithNoise) {
  reconstruct::Field noise = constant(1.0f, 1);
  for (int y = 0; y < kHeight; ++y) std::fill_n(noise.row(y), kWidth / 2, 0.0f);
  const reconstruct::Field picture = restored(bright_samples(100, 10.0f), noise);
  EXPECT_EQ(picture.row(5)[5], 1.0f);
  EXPECT_GT(picture.row(5)[kWidth - 5], 1.5f);
}

// Samples of several frames add up, each by the share of them that counts.
TEST(B2_LostLight, SamplesCountByTheirShare) {
  const reconstruct::Field noise = constant(1.0f, 1), picture = constant(1.0f), residual = bright_samples(100, 20.0f);
  reconstruct::LightOfSamples samples = light_of(picture, residual, residual);
  const double once = sum_of(reconstruct::restore_lost_light(picture, picture, noise, samples));
  for (reconstruct::Field* field : {&samples.share, &samples.light, &samples.variance})
    add(reconstruct::Field(*field), field);
  // Two equal frames, whose variances would be those of a sum of independent samples, lose as much light as one.
  EXPECT_NEAR(sum_of(reconstruct::restore_lost_light(picture, picture, noise, samples)) / once, 1.0, 0.01);
  EXPECT_GT(once, 1.5 * sum_of(picture));
}

// Where little of the picture is noisy, that part would take what all of it lacks.
TEST(B2_LostLight, FactorsAreBounded) {
  for (const float offset : {-0.02f, 0.02f}) {
    reconstruct::Field picture = constant(10.0f), noise = constant(1e-4f, 1), residual = constant(10.0f * offset);
    for (int c = 0; c < 3; ++c) std::fill_n(picture.row(9, c), kWidth, 0.01f);
    std::fill_n(noise.row(9), kWidth, 1.0f);
    const reconstruct::Field factors =
        reconstruct::restore_lost_light(picture, picture, noise, light_of(picture, residual, constant(0.0f)));
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
  picture = reconstruct::restore_lost_light(picture, picture, noise, light_of(picture, residual, half));
  EXPECT_LT(picture.row(0)[0], 1.3f);
  EXPECT_GT(picture.row(0)[kWide - 1], 1.7f);
  for (int x = 1; x < kWide; ++x) ASSERT_LT(std::fabs(picture.row(0)[x] - picture.row(0)[x - 1]), 0.003f) << x;
}

}  // namespace
}  // namespace gradus::lost_light_test
