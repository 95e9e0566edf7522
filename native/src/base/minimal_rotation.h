// The smallest rotation from one unit vector to another.
#pragma once

#include "base/types.h"

namespace gradus {

// Applies the smallest rotation that takes the unit vector `from` to the unit vector `to` to `v`. If the two are nearly
// opposite the smallest rotation is not unique, and the result is −v.
inline Vec3 turned(const Vec3& v, const Vec3& from, const Vec3& to) {
  const float cosine = glm::dot(from, to);
  if (!(cosine > -0.999f)) return cosine < 0.0f ? -v : v;
  const Vec3 axis = glm::cross(from, to);
  return v * cosine + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (1.0f + cosine));
}

}  // namespace gradus
