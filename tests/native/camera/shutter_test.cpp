// The shutter curve as a density of times, and shutters that never open.
#include "camera/shutter.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace gradus::shutter_test {
namespace {

camera::Shutter make_shutter(float open, float close, const std::vector<float>& curve) {
  GradusCamera camera{};
  camera.shutter_open = open;
  camera.shutter_close = close;
  camera.shutter_curve = curve.empty() ? nullptr : curve.data();
  camera.shutter_curve_count = uint32_t(curve.size());
  return camera::Shutter(camera);
}

// Returns the integral of the curve from 0 to x relative to the whole.
double share_before(const std::vector<float>& curve, double x) {
  const auto integral = [&](double end) {
    double sum = 0.0;
    const double step = 1.0 / double(curve.size() - 1);
    for (size_t i = 0; i + 1 < curve.size(); ++i) {
      const double part = std::clamp((end - double(i) * step) / step, 0.0, 1.0);
      sum += step * (curve[i] * part + 0.5 * (double(curve[i + 1]) - curve[i]) * part * part);
    }
    return sum;
  };
  return integral(x) / integral(1.0);
}

TEST(Shutter, TimesAreDistributedAsTheCurve) {
  for (const std::vector<float>& curve : {std::vector<float>{1, 1},
                                          {0, 1},
                                          {1, 0},
                                          {0, 2, 0},
                                          {0, 0, 1, 0, 0},
                                          {3, 1, 0.5f, 4, 4, 0},
                                          {1e-20f, 1e-20f},
                                          {1e20f, 0, 1e20f}}) {
    const camera::Shutter shutter = make_shutter(-0.25f, 0.25f, curve);
    EXPECT_TRUE(shutter.opens());
    for (int i = 0; i < 1000; ++i) {
      const float u = (float(i) + 0.5f) / 1000.0f;
      const float time = shutter.sample(u);
      ASSERT_GE(time, 0.0f);
      ASSERT_LE(time, 1.0f);
      EXPECT_NEAR(share_before(curve, time), u, 2e-6) << curve.size() << ' ' << i;
    }
  }
}

TEST(Shutter, WithoutACurveAllTimesHaveTheSameDensity) {
  const camera::Shutter shutter = make_shutter(0.0f, 0.5f, {});
  EXPECT_EQ(shutter.sample(0.25f), 0.25f);
}

// Correspondences and vectors refer to the time of the frame, which may lie anywhere in the exposure.
TEST(Shutter, KnowsTheTimeOfTheFrame) {
  EXPECT_FLOAT_EQ(make_shutter(-0.25f, 0.25f, {}).time_of_frame(), 0.5f);
  EXPECT_FLOAT_EQ(make_shutter(-0.5f, 0.0f, {}).time_of_frame(), 1.0f);
  EXPECT_FLOAT_EQ(make_shutter(-0.1f, 0.4f, {}).time_of_frame(), 0.2f);
  EXPECT_EQ(make_shutter(0.0f, 0.0f, {}).time_of_frame(), 0.0f);
}

TEST(Shutter, DoesNotOpenForAnInvalidCurve) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(make_shutter(0.0f, 0.0f, {}).opens());
  EXPECT_FALSE(make_shutter(0.5f, -0.5f, {}).opens());
  EXPECT_FALSE(make_shutter(nan, 1.0f, {}).opens());
  EXPECT_FALSE(make_shutter(0.0f, infinity, {}).opens());
  EXPECT_FALSE(make_shutter(0.0f, 1.0f, {0, 0, 0}).opens());
  EXPECT_FALSE(make_shutter(0.0f, 1.0f, {nan, -1, infinity}).opens());
  EXPECT_TRUE(make_shutter(0.0f, 1.0f, {nan, 1, -1}).opens());
}

}  // namespace
}  // namespace gradus::shutter_test
