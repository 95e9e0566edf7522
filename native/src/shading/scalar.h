// Scalar functions that are defined for every argument. For invalid arguments they return what shading languages
// return.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::shading {

// Clamps to 0…1. NaN becomes 0, so that the result can be converted to an index.
inline float saturate(float x) { return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f; }
inline float safe_divide(float a, float b) { return b != 0.0f ? a / b : 0.0f; }
inline float safe_modulo(float a, float b) { return b != 0.0f ? std::fmod(a, b) : 0.0f; }
inline float fraction(float x) { return x - std::floor(x); }
// Returns a power, or 0 for a negative base with an exponent that is not an integer.
inline float safe_power(float a, float b) { return a < 0.0f && b != std::trunc(b) ? 0.0f : std::pow(a, b); }
inline float sign(float x) { return x > 0.0f ? 1.0f : x < 0.0f ? -1.0f : 0.0f; }
inline float wrap(float x, float upper, float lower) {
  const float range = upper - lower;
  return range != 0.0f ? x - range * std::floor((x - lower) / range) : lower;
}
inline float snap(float x, float step) { return std::floor(safe_divide(x, step)) * step; }
inline float smoothstep(float lower, float upper, float x) {
  if (x < lower) return 0.0f;
  if (x >= upper) return 1.0f;
  const float t = (x - lower) / (upper - lower);
  return t * t * (3.0f - 2.0f * t);
}
inline float smootherstep(float lower, float upper, float x) {
  const float t = saturate(safe_divide(x - lower, upper - lower));
  return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}
// Returns the unit vector, or zero if the vector has no direction.
inline Vec3 safe_normalize(const Vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f && is_finite(length) ? v / length : Vec3(0.0f);
}
// Converts to an int, clamped to ±2·10⁹.
inline int to_int(float x) { return x > -2e9f ? (x < 2e9f ? static_cast<int>(x) : 2000000000) : -2000000000; }

// Returns the reflectance of a dielectric interface for unpolarised light. `eta` is the IOR of the far side over that
// of the near side.
inline float dielectric_reflectance(float cosine, float eta) {
  const float c = std::fabs(cosine);
  const float g2 = eta * eta - 1.0f + c * c;
  if (!(g2 > 0.0f)) return 1.0f;
  const float g = std::sqrt(g2);
  const float a = (g - c) / (g + c);
  const float b = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
  return 0.5f * a * a * (1.0f + b * b);
}

}  // namespace gradus::shading
