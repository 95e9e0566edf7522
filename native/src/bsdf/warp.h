// Mappings from the unit square to directions around +z.
#pragma once

#include <algorithm>
#include <cmath>

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

}  // namespace gradus::bsdf
