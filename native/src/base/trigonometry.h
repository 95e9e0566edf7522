// Fast trigonometric functions: inlined polynomials with about the precision of a float. They are cheaper than those of
// the C library, which compute in double and handle the whole range of arguments, and overlap with other work.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace gradus {

struct SineCosine {
  float sine, cosine;
};

// Returns the sine and cosine of `x`, an angle of at most a few turns in radians. The angle is reduced to an eighth
// of a turn, where the polynomials of Cephes' sinf() and cosf() apply (Moshier 1989).
inline SineCosine sine_cosine(float x) {
  const float quarters = std::rint(x * 0.636619772f);
  const float r = std::fma(quarters, 4.37113883e-8f, std::fma(-quarters, 1.57079637f, x));
  const float z = r * r;
  const float s = r + r * z * (-1.6666654611e-1f + z * (8.3321608736e-3f - z * 1.9515295891e-4f));
  const float c =
      1.0f - 0.5f * z + z * z * (4.166664568298827e-2f + z * (-1.388731625493765e-3f + z * 2.443315711809948e-5f));
  // The quarter of the turn selects by bit masks, because a branch on it would be unpredictable.
  const auto n = static_cast<uint32_t>(static_cast<int32_t>(quarters));
  const uint32_t keep = (n & 1u) - 1u, sines = std::bit_cast<uint32_t>(s), cosines = std::bit_cast<uint32_t>(c);
  return {std::bit_cast<float>(((sines & keep) | (cosines & ~keep)) ^ ((n & 2u) << 30)),
          std::bit_cast<float>(((cosines & keep) | (sines & ~keep)) ^ (((n + 1u) & 2u) << 30))};
}

// Returns atan2(y, x) with a relative error of at most 2e-8 (Abramowitz and Stegun 4.4.49). (0, 0) is not allowed. Note
// the order of the parameters, x before y.
inline double angle_of(double x, double y) {
  const double ax = std::abs(x), ay = std::abs(y);
  const double t = std::min(ax, ay) / std::max(ax, ay);
  const double z = t * t, z2 = z * z, z4 = z2 * z2;
  const double low = (1.0 - 0.3333314528 * z) + z2 * (0.1999355085 - 0.1420889944 * z);
  const double high = (0.1065626393 - 0.0752896400 * z) + z2 * (0.0429096138 - 0.0161657367 * z);
  constexpr double pi = 3.14159265358979323846;
  double angle = t * (low + z4 * (high + z4 * 0.0028662257));
  angle = ay > ax ? 0.5 * pi - angle : angle;
  return std::copysign(x < 0.0 ? pi - angle : angle, y);
}

}  // namespace gradus
