#include "guide/direction_mixture.h"

#include <algorithm>
#include <cmath>

#include "base/orthonormal_basis.h"
#include "base/trigonometry.h"

namespace gradus::guide {
namespace {

// Returns exp(x) for x ≤ 0 with a relative error below 3e-6, or about 1e-35 where it is less: a power of two times a
// polynomial, the first terms of the series of 2^f for |f| ≤ 1/2.
FloatLanes exponential(FloatLanes x) {
  const FloatLanes t = maximum(x, FloatLanes{} - 80.0f) * 1.44269504f;
  const FloatLanes n = nearest_integers(t);
  const FloatLanes f = t - n;
  const FloatLanes p =
      1.0f + f * (0.69314718f + f * (0.24022651f + f * (0.05550411f + f * (0.00961813f + f * 0.00133336f))));
  return p * power_of_two(n);
}

}  // namespace

void DirectionMixture::finish() {
  const float inverse = 1.0f / sum_of(weight);
  for (size_t r = 0; r < kRegisters; ++r) {
    weight[r] *= inverse;
    scale_[r] = weight[r] * concentration[r] / (2.0f * kPi * (1.0f - exponential(-2.0f * concentration[r])));
  }
}

LobeValues DirectionMixture::parts(const Vec3& d) const {
  LobeValues parts;
  for (size_t r = 0; r < kRegisters; ++r) {
    // The cosine minus 1 is −|a − d|²/2, which keeps its digits where the vectors are close.
    const FloatLanes ex = x[r] - d.x, ey = y[r] - d.y, ez = z[r] - d.z;
    parts[r] = scale_[r] * exponential(-0.5f * concentration[r] * (ex * ex + ey * ey + ez * ez));
  }
  return parts;
}

// Inverts the distribution of the cosine (Jakob, "Numerically stable sampling of the von Mises-Fisher distribution on
// S²", 2012).
Vec3 DirectionMixture::sample(float choice, const Vec2& u) const {
  size_t chosen = 0;
  float sum = 0.0f;
  for (size_t i = 0; i < kLobes && !(choice < sum); ++i) {
    const float w = get(weight, i);
    if (w > 0.0f) chosen = i;
    sum += w;
  }
  const float k = get(concentration, chosen);
  const float below = std::log(1.0f - u.x * (1.0f - std::exp(-2.0f * k))) / k;  // the cosine minus 1
  const float sine = std::sqrt(std::max(0.0f, -below * (2.0f + below)));
  const SineCosine phi = sine_cosine(2.0f * kPi * u.y);
  const Vec3 n = axis(chosen);
  Vec3 a, b;
  orthonormal_basis(n, &a, &b);
  return (sine * phi.cosine) * a + (sine * phi.sine) * b + (1.0f + below) * n;
}

}  // namespace gradus::guide
