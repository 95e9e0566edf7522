// Values between the centres of pixels.
#include "reconstruct/displaced.h"

#include <cmath>

#include <gtest/gtest.h>

#include "reconstruct/field_values.h"

namespace gradus::displaced_test {
namespace {

constexpr int kWidth = 24, kHeight = 18;

// Returns an image of a quadratic function, which cubic convolution reproduces.
float quadratic(float x, float y) { return 1.0f + 0.3f * x - 0.2f * y + 0.02f * x * y + 0.01f * x * x - 0.03f * y * y; }

TEST(B2_Displaced, ReproducesQuadraticFunctions) {
  const reconstruct::Field image =
      reconstruct::make_field(kWidth, kHeight, [](int x, int y) { return quadratic(float(x), float(y)); });
  reconstruct::Field displacement(kWidth, kHeight, 2);
  for_values(&displacement,
             [](float& value, int x, int y, int c) { value = 0.5f * std::sin(float(c == 0 ? 3 * x + y : x + 5 * y)); });
  const reconstruct::Field moved = reconstruct::displaced(image, displacement);
  for (int y = 3; y < kHeight - 3; ++y) {
    for (int x = 3; x < kWidth - 3; ++x) {
      const float expected = quadratic(float(x) + displacement.row(y, 0)[x], float(y) + displacement.row(y, 1)[x]);
      ASSERT_NEAR(moved.row(y)[x], expected, 1e-4f) << x << " " << y;
    }
  }
}

TEST(B2_Displaced, GoesOnBeyondTheBorder) {
  const reconstruct::Field image = reconstruct::make_field(kWidth, kHeight, [](int x, int) { return float(x == 0); });
  reconstruct::Field displacement(kWidth, kHeight, 2);
  for_values(&displacement, [](float& value, int, int, int c) { value = c == 0 ? -2.5f : 0.0f; });
  const reconstruct::Field moved = reconstruct::displaced(image, displacement);
  EXPECT_NEAR(moved.row(4)[0], 1.0f, 1e-6f);
  EXPECT_NEAR(moved.row(4)[kWidth - 1], 0.0f, 1e-6f);
}

TEST(B2_Displaced, WithoutDisplacementIsTheImage) {
  const reconstruct::Field image = reconstruct::make_field(1, 3, [](int, int y) { return 0.1f * float(y); });
  const reconstruct::Field moved = reconstruct::displaced(image, reconstruct::Field(1, 3, 2));
  for (int y = 0; y < 3; ++y) EXPECT_EQ(moved.row(y)[0], image.row(y)[0]);
}

}  // namespace
}  // namespace gradus::displaced_test
