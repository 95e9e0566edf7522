// Mappings from the unit square to directions around +z.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/orthonormal_basis.h"
#include "base/trigonometry.h"
#include "base/types.h"

namespace gradus::bsdf {

// Samples a direction with the density cos/π by Malley's method: a uniform point of the unit disk, projected up to the
// hemisphere.
inline Vec3 sample_cosine_hemisphere(const Vec2& u) {
  const float radius = std::sqrt(u.x);
  const SineCosine phi = sine_cosine(2.0f * kPi * u.y);
  return Vec3(radius * phi.cosine, radius * phi.sine, std::sqrt(std::max(0.0f, 1.0f - u.x)));
}

// Returns a direction whose density is the cosine to the unit vector `normal` over pi.
inline Vec3 sample_cosine_around(const Vec3& normal, const Vec2& u) {
  Vec3 x, y;
  orthonormal_basis(normal, &x, &y);
  const Vec3 d = sample_cosine_hemisphere(u);
  return d.x * x + d.y * y + d.z * normal;
}

}  // namespace gradus::bsdf
