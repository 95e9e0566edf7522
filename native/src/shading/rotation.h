// Rotations of shader nodes.
#pragma once

#include <cmath>

#include "base/types.h"

namespace gradus::shading {

// Returns the matrix R = Rz·Ry·Rx of the Euler angles in the order X, Y, Z, in radians.
inline Mat3 euler_matrix(const Vec3& angles) {
  if (angles == Vec3(0.0f)) return Mat3(1.0f);  // the default of most nodes
  const float cx = std::cos(angles.x), sx = std::sin(angles.x);
  const float cy = std::cos(angles.y), sy = std::sin(angles.y);
  const float cz = std::cos(angles.z), sz = std::sin(angles.z);
  return Mat3(Vec3(cy * cz, cy * sz, -sy), Vec3(sy * sx * cz - cx * sz, sy * sx * sz + cx * cz, cy * sx),
              Vec3(sy * cx * cz + sx * sz, sy * cx * sz - sx * cz, cy * cx));
}

// Rotates `v` around the unit vector `axis` by `angle` radians, by Rodrigues' formula.
inline Vec3 rotate_around(const Vec3& v, const Vec3& axis, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return v * c + glm::cross(axis, v) * s + axis * (glm::dot(axis, v) * (1.0f - c));
}

}  // namespace gradus::shading
