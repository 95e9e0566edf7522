// Safe scalar functions: defined for every argument, with the values that shading languages agree on.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::shading {

// NaN becomes 0, so that what is saturated can be an index.
inline float saturate(float x) { return x > 0.0f ? (x < 1.0f ? x : 1.0f) : 0.0f; }
inline float safe_divide(float a, float b) { return b != 0.0f ? a / b : 0.0f; }
inline float safe_modulo(float a, float b) { return b != 0.0f ? std::fmod(a, b) : 0.0f; }
inline float fraction(float x) { return x - std::floor(x); }
// Real powers only: negative bases take whole exponents.
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
// Zero for vectors without a direction.
inline Vec3 safe_normalize(const Vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f && is_finite(length) ? v / length : Vec3(0.0f);
}
// To an int, whatever the argument.
inline int to_int(float x) { return x > -2e9f ? (x < 2e9f ? static_cast<int>(x) : 2000000000) : -2000000000; }

// Unpolarised reflectance of a dielectric interface; eta: index of the far side over that of the near side.
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
