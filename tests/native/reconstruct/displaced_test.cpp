// Values between the centres of pixels.
#include "reconstruct/displaced.h"

#include <array>
#include <cmath>

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

TEST(B2_Displaced, WithoutDisplacementIsTheImage) {
  const reconstruct::Field image = reconstruct::make_field(1, 3, [](int, int y) { return 0.1f * float(y); });
  const reconstruct::Field moved =
      reconstruct::displaced(image, reconstruct::Field(1, 3, reconstruct::kDisplacementChannels));
  for (int y = 0; y < 3; ++y) EXPECT_EQ(moved.row(y)[0], image.row(y)[0]);
}

}  // namespace
}  // namespace gradus::displaced_test
