// The share of its own sampled light that a pixel keeps where windows would make it black.
#include "reconstruct/regression/restore_sampled_light.h"

#include <gtest/gtest.h>

#include "reconstruct/field_values.h"

namespace gradus::restore_sampled_light_test {
namespace {

constexpr int kSize = 5, kCentre = 2;

reconstruct::Field constant(float value) {
  return reconstruct::make_field(kSize, kSize, [value](int, int) { return value; });
}

// Returns the centre pixel after the correction.
float kept(const reconstruct::Field& sampled, float regressed) {
  reconstruct::Field image = constant(1.0f);
  image.row(kCentre)[kCentre] = regressed;
  reconstruct::blend_sampled(reconstruct::restore_sampled_light(sampled, image), sampled, &image);
  return image.row(kCentre)[kCentre];
}

TEST(B2_RestoreSampledLight, KeepsAQuarterOfTheSampledLightAtLeast) {
  EXPECT_NEAR(kept(constant(1.0f), -3.0f), 0.25f, 1e-6f);
  EXPECT_NEAR(kept(constant(1.0f), 0.1f), 0.25f, 1e-6f);
}

TEST(B2_RestoreSampledLight, BrighterPixelsAreUnchanged) {
  for (const float regressed : {0.25f, 0.5f, 2.0f}) EXPECT_EQ(kept(constant(1.0f), regressed), regressed);
}

TEST(B2_RestoreSampledLight, AFireflyCountsAsItsNeighbours) {
  reconstruct::Field sampled = constant(1.0f);
  sampled.row(kCentre)[kCentre] = 1000.0f;
  EXPECT_NEAR(kept(sampled, -1.0f), 0.25f, 1e-3f);
}

TEST(B2_RestoreSampledLight, ADarkPixelStaysDark) {
  reconstruct::Field sampled = constant(1.0f);
  sampled.row(kCentre)[kCentre] = 0.0f;
  EXPECT_EQ(kept(sampled, 0.01f), 0.01f);
  EXPECT_NEAR(kept(sampled, -1.0f), 0.0f, 1e-6f);
}

TEST(B2_RestoreSampledLight, AllChannelsUseTheShareOfTheDarkest) {
  reconstruct::Field sampled(kSize, kSize, 3), regressed(kSize, kSize, 3);
  for_values(&sampled, [](float& value, int, int, int) { value = 1.0f; });
  for_values(&regressed, [](float& value, int, int, int c) { value = c == 1 ? -1.0f : 0.5f; });
  const reconstruct::Field share = reconstruct::restore_sampled_light(sampled, regressed);
  EXPECT_NEAR(share.row(0)[0], 0.625f, 1e-6f);
  reconstruct::blend_sampled(share, sampled, &regressed);
  EXPECT_NEAR(regressed.row(0, 1)[0], 0.25f, 1e-6f);
  EXPECT_NEAR(regressed.row(0, 0)[0], 0.8125f, 1e-6f);
}

}  // namespace
}  // namespace gradus::restore_sampled_light_test
