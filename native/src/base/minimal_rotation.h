// The smallest rotation from one unit vector to another.
#pragma once

#include "base/types.h"

namespace gradus {

// v, turned as `from` is when it becomes `to`. Where they are opposite no turn is smallest: v is mirrored at the
// origin.
inline Vec3 turned(const Vec3& v, const Vec3& from, const Vec3& to) {
  const float cosine = glm::dot(from, to);
  if (!(cosine > -0.999f)) return cosine < 0.0f ? -v : v;
  const Vec3 axis = glm::cross(from, to);
  return v * cosine + glm::cross(axis, v) + axis * (glm::dot(axis, v) / (1.0f + cosine));
}

}  // namespace gradus
