// The plane of a triangle, with bounds on rounding errors.
#pragma once

#include <array>
#include <limits>

#include "base/types.h"

namespace gradus::geometry {

// Returns gamma(n) = n·u / (1 - n·u), the bound on the relative error of n rounded operations, where u is the unit
// roundoff. Source: Higham; pbrt-v4 section 6.8.1.
constexpr float gamma_bound(int n) {
  constexpr float unit_roundoff = std::numeric_limits<float>::epsilon() * 0.5f;
  return float(n) * unit_roundoff / (1.0f - float(n) * unit_roundoff);
}

// Returns the unit vector in the direction of v, also if the square of its length underflows or overflows. Returns
// `fallback` if v has no direction: it is 0 or not finite.
Vec3 safe_unit(const Vec3& v, const Vec3& fallback);

struct Plane {
  Vec3 normal{0, 0, 1};  // unit
  float error = 0.0f;    // bound on the error of the plane equation that the next ray computes, as a distance
};
// Returns the plane of a triangle. The corners run counter-clockwise around the normal. A triangle without area has the
// normal (0, 0, 1).
Plane plane_of(const std::array<Vec3, 3>& corners);

}  // namespace gradus::geometry
