// Values between the centres of pixels.
#include "reconstruct/displaced.h"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "reconstruct/field_values.h"

namespace gradus::displaced_test {
namespace {

constexpr int kWidth = 24, kHeight = 18;

// A quadratic function, which derivatives of second order describe.
float quadratic(float x, float y) { return 1.0f + 0.3f * x - 0.2f * y + 0.02f * x * y + 0.01f * x * x - 0.03f * y * y; }

// If a pixel holds several samples, the result is the mean of the image where they lie.
TEST(B2_Displaced, ReproducesQuadraticFunctions) {
  const reconstruct::Field image =
      reconstruct::make_field(kWidth, kHeight, [](int x, int y) { return quadratic(float(x), float(y)); });
  const auto by = [](int x, int y, int sample) {
    return Vec2{0.5f * std::sin(float(3 * x + y + 7 * sample)), 0.5f * std::sin(float(x + 5 * y + 4 * sample))};
  };
  for (const int samples : {1, 3}) {
    reconstruct::Field displacements(kWidth, kHeight, reconstruct::kDisplacementChannels);
    for_values(&displacements, [&](float& value, int x, int y, int c) {
      for (int sample = 0; sample < samples; ++sample) {
        const reconstruct::Displacement of = reconstruct::displaced_by(by(x, y, sample));
        value += std::array{of.x, of.y, of.xx, of.xy, of.yy}[size_t(c)] / float(samples);
      }
    });
    const reconstruct::Field moved = reconstruct::displaced(image, displacements);
    for (int y = 1; y < kHeight - 1; ++y) {
      for (int x = 1; x < kWidth - 1; ++x) {
        float expected = 0.0f;
        for (int sample = 0; sample < samples; ++sample) {
          const Vec2 at = by(x, y, sample);
          expected += quadratic(float(x) + at.x, float(y) + at.y) / float(samples);
        }
        ASSERT_NEAR(moved.row(y)[x], expected, 1e-4f) << x << " " << y;
      }
    }
  }
}

// The pixels of the border repeat beyond it.
TEST(B2_Displaced, GoesOnBeyondTheBorder) {
  const reconstruct::Field image = reconstruct::make_field(kWidth, kHeight, [](int, int) { return 3.0f; });
  reconstruct::Field displacement(kWidth, kHeight, reconstruct::kDisplacementChannels);
  for_values(&displacement, [](float& value, int x, int y, int) { value = x < y ? 0.5f : -0.5f; });
  const reconstruct::Field moved = reconstruct::displaced(image, displacement);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) ASSERT_EQ(moved.row(y)[x], 3.0f) << x << " " << y;
}

// Samples beside the centres of their pixels, of a picture that is known up to a constant, give the picture there. This
// also holds where light is negative.
TEST(B2_Displaced, MovesMeansToTheCentres) {
  for (const float sign : {1.0f, -1.0f}) {
    const reconstruct::Field picture =
        reconstruct::make_field(kWidth, kHeight, [sign](int x, int y) { return sign * quadratic(float(x), float(y)); });
    reconstruct::Field displacements(kWidth, kHeight, reconstruct::kDisplacementChannels);
    for_values(&displacements, [](float& value, int x, int y, int c) {
      const reconstruct::Displacement by = reconstruct::displaced_by({0.4f, x < y ? 0.3f : -0.2f});
      value = std::array{by.x, by.y, by.xx, by.xy, by.yy}[size_t(c)];
    });
    reconstruct::Field means = reconstruct::displaced(picture, displacements);
    for_values(&means, [sign](float& value, int, int, int) { value += 7.0f * sign; });
    move_to_centres(picture, displacements, &means);
    for (int y = 1; y < kHeight - 1; ++y) {
      for (int x = 1; x < kWidth - 1; ++x) {
        if (sign * means.row(y)[x] == 0.0f) continue;  // would have changed its sign
        ASSERT_NEAR(means.row(y)[x], picture.row(y)[x] + 7.0f * sign, 1e-4f) << x << " " << y;
      }
    }
    EXPECT_NEAR(means.row(2)[2], picture.row(2)[2] + 7.0f * sign, 1e-4f);
  }
}

// A parabola through pixels beside a step is lower than all of them.
TEST(B2_Displaced, MovesMeansWithinTheRangeOfThePictureAndNotBelowBlack) {
  const reconstruct::Field step =
      reconstruct::make_field(kWidth, kHeight, [](int x, int) { return x < kWidth / 2 ? 0.0f : 800.0f; });
  reconstruct::Field displacements(kWidth, kHeight, reconstruct::kDisplacementChannels);
  for_values(&displacements, [](float& value, int, int, int c) { value = c == 0 ? -0.5f : (c == 2 ? 0.25f : 0.0f); });
  reconstruct::Field dark = reconstruct::make_field(kWidth, kHeight, [](int, int) { return 1.0f; });
  move_to_centres(step, displacements, &dark);
  EXPECT_EQ(dark.row(3)[kWidth / 2 - 1], 1.0f);
  for_values(&displacements, [](float& value, int, int, int) { value = std::fabs(value); });
  move_to_centres(step, displacements, &dark);
  EXPECT_EQ(dark.row(3)[kWidth / 2 - 1], 0.0f);
}

TEST(B2_Displaced, LeavesMeansWhereThePictureIsNotFinite) {
  reconstruct::Field picture = reconstruct::make_field(kWidth, kHeight, [](int x, int) { return float(x); });
  picture.row(5)[5] = std::numeric_limits<float>::infinity();
  reconstruct::Field displacements(kWidth, kHeight, reconstruct::kDisplacementChannels);
  for (int y = 0; y < kHeight; ++y) displacements.row(y, 0)[7] = 0.25f;
  reconstruct::Field means = picture;
  means.row(5)[5] = 5.0f;
  move_to_centres(picture, displacements, &means);
  for (int x = 4; x <= 6; ++x) EXPECT_EQ(means.row(5)[x], float(x));
  EXPECT_EQ(means.row(5)[7], 6.75f);
}

TEST(B2_Displaced, WithoutDisplacementIsTheImage) {
  const reconstruct::Field image = reconstruct::make_field(1, 3, [](int, int y) { return 0.1f * float(y); });
  const reconstruct::Field moved =
      reconstruct::displaced(image, reconstruct::Field(1, 3, reconstruct::kDisplacementChannels));
  for (int y = 0; y < 3; ++y) EXPECT_EQ(moved.row(y)[0], image.row(y)[0]);
}

}  // namespace
}  // namespace gradus::displaced_test
