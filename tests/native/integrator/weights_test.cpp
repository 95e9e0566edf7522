// B8: the weights of all techniques and both directions of a pair add up to 1.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "gradient/gradient_accumulator.h"
#include "path/light.h"
#include "support/statistics.h"

namespace gradus::weights_test {
namespace {

// A path x and its shift y, with the densities of light and BSDF sampling at both and the Jacobian.
struct Densities {
  float light_x, bsdf_x, light_y, bsdf_y, jacobian;
};

Densities random_densities(std::mt19937* random) {
  std::uniform_real_distribution<float> exponent(-12.0f, 12.0f);
  std::uniform_real_distribution<float> kind(0.0f, 1.0f);
  Densities d{std::exp(exponent(*random)), std::exp(exponent(*random)), std::exp(exponent(*random)),
              std::exp(exponent(*random)), std::exp(0.25f * exponent(*random))};
  if (kind(*random) < 0.1f) {
    d.light_x = d.light_y = 0.0f;  // a light that light sampling excludes
  }
  return d;
}

// Returns the weight of a sample of technique density `pdf` at x: its share in the coefficient of f(x) of the estimate,
// times its density. PairCount works on C = f/(sum of densities); `own` is the base's count.
double weight(const gradient::PairCount& pair, float r, double share) {
  const Radiance with_base = pair.paired(Radiance(1.0f), Radiance(0.0f), r);
  return -double(with_base.x) / pair.weight() * share;
}

TEST(B8_Weights, TechniquesAndDirectionsSumToOne) {
  std::mt19937 random(1);
  for (int i = 0; i < 100000; ++i) {
    const Densities d = random_densities(&random);
    const gradient::PairCount forward{float(1 + i % 5), float(1 + i % 3)};
    const gradient::PairCount backward{forward.other, forward.own};
    const float total_x = d.light_x + d.bsdf_x;
    const float total_y = d.light_y + d.bsdf_y;
    const float r = d.jacobian * total_y / total_x;
    // Light and BSDF samples of x, weighted by their shares of the density of x.
    const double bsdf_share = path::bsdf_weight(d.light_x, d.bsdf_x);
    const double there = weight(forward, r, bsdf_share) + weight(forward, r, 1.0 - bsdf_share);
    // Base paths y with the inverse shift add C(x)·(1/r) at the density of y to the same coefficient.
    const Radiance shifted = backward.paired(Radiance(0.0f), Radiance(1.0f), 1.0f / r);
    const double back = double(shifted.x) / backward.weight() * r;
    EXPECT_NEAR(there + back, 1.0, 1e-6);
  }
}

// Weights equal the same arithmetic in double over the range of Jacobians and densities.
TEST(B8_Weights, FloatIsEnough) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> value(0.0f, 5.0f), exponent(-20.0f, 20.0f);
  for (int i = 0; i < 100000; ++i) {
    const gradient::PairCount pair{float(1 + i % 5), float(1 + i % 3)};
    const float r = std::exp(exponent(random)), base = value(random), offset = value(random);
    const double q = double(pair.other) / double(pair.own), weight = 0.5 * (1.0 + q) / (1.0 + q * double(r));
    const double exact = (double(r) * double(offset) - double(base)) * weight;
    const double scale = (double(r) * double(offset) + double(base)) * weight;  // magnitude of the terms
    EXPECT_NEAR(pair.paired(Radiance(base), Radiance(offset), r).x, exact, 1e-6 * scale);
  }
}

TEST(B8_Weights, FailedShiftCountsTheBaseAlone) {
  const gradient::PairCount pair{3.0f, 2.0f};
  EXPECT_FLOAT_EQ(pair.unpaired(Radiance(1.0f)).x / pair.weight(), -1.0f);
}

// Swapping base and offset negates the estimated gradient, so the samples of both ends are opposite.
TEST(B4_Shift, SwapNegates) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> value(0.0f, 5.0f), exponent(-9.0f, 9.0f);
  const int shifts = test::full_run() ? 1000000 : 100000;
  for (int i = 0; i < shifts; ++i) {
    const gradient::PairCount pair{float(1 + i % 5), float(1 + i % 3)};
    const gradient::PairCount swapped{pair.other, pair.own};
    const float r = std::exp(exponent(random));
    const Radiance base(value(random), value(random), 0.0f, value(random));
    const Radiance offset(value(random), 0.0f, value(random), value(random));
    const Radiance there = pair.paired(base, offset, r);
    const Radiance back = swapped.paired(offset, base, 1.0f / r);
    for (int c = 0; c < 4; ++c) ASSERT_NEAR(there[c], -back[c], 1e-5f * (1.0f + std::fabs(there[c]))) << "r = " << r;
  }
}

}  // namespace
}  // namespace gradus::weights_test
