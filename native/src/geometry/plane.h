// The plane of a triangle, and how far rounding may move what is computed from it.
#pragma once

#include <array>
#include <limits>

#include "base/types.h"

namespace gradus::geometry {

// gamma(n) = n·u / (1 - n·u), the bound of n rounded operations (Higham; pbrt-v4 section 6.8.1).
constexpr float gamma_bound(int n) {
  constexpr float unit_roundoff = std::numeric_limits<float>::epsilon() * 0.5f;
  return float(n) * unit_roundoff / (1.0f - float(n) * unit_roundoff);
}

// Unit vector, also where the square of the length leaves float's range; `fallback` where there is none.
Vec3 safe_unit(const Vec3& v, const Vec3& fallback);

struct Plane {
  Vec3 normal{0, 0, 1};  // unit
  float error = 0.0f;    // of the plane equation that the next ray computes
};
Plane plane_of(const std::array<Vec3, 3>& corners);

}  // namespace gradus::geometry
