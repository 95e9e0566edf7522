// Local frames of lobes: z along the lobe's normal, x along its tangent.
#pragma once

#include <cmath>

#include "base/types.h"

namespace gradus::bsdf {

struct Frame3 {
  Vec3 x;
  Vec3 y;
  Vec3 z;

  Vec3 to_local(const Vec3& v) const { return Vec3(glm::dot(v, x), glm::dot(v, y), glm::dot(v, z)); }
  Vec3 to_world(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
};

// Returns a unit vector perpendicular to a unit normal, well defined for all normals (Duff et al., "Building an
// Orthonormal Basis, Revisited", JCGT 2017).
inline Vec3 perpendicular(const Vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  return Vec3(1.0f + sign * n.x * n.x * a, sign * n.x * n.y * a, -sign * n.x);
}

// Returns the component of `tangent` perpendicular to the unit normal, normalised. If that vanishes it returns another
// perpendicular direction.
inline Vec3 orthonormal_tangent(const Vec3& normal, const Vec3& tangent) {
  const Vec3 across = tangent - normal * glm::dot(normal, tangent);
  const float length2 = glm::dot(across, across);
  if (!(length2 > 1e-12f) || !is_finite(length2)) {
    return perpendicular(normal);
  }
  return across / std::sqrt(length2);
}

// Normalises a vector that has unit length except for rounding errors, by one Newton step.
inline Vec3 renormalise(const Vec3& v) { return v * (1.5f - 0.5f * glm::dot(v, v)); }

inline Frame3 make_frame(const Vec3& normal, const Vec3& tangent) {
  return {tangent, glm::cross(normal, tangent), normal};
}

}  // namespace gradus::bsdf
