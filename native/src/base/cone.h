// Cones of directions, which describe sun lights and spheres seen from outside.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/orthonormal_basis.h"

namespace gradus {

// A circular cone around a unit axis. Its size is stored as 1 − cos of the half angle, because small angles keep
// their precision that way.
struct Cone {
  Vec3 axis = Vec3(0, 0, 1);
  float one_minus_cos = 0.0f;

  bool contains(const Vec3& direction) const {
    const Vec3 d = direction - axis;
    return glm::dot(d, d) <= 2.0f * one_minus_cos;
  }
  // Returns the solid angle in steradians.
  float solid_angle() const { return 2.0f * kPi * one_minus_cos; }
  // Returns the sine of the half angle.
  float sine() const { return std::sqrt(std::max(0.0f, one_minus_cos * (2.0f - one_minus_cos))); }

  // Returns a unit direction, uniform over the solid angle for a uniform `u` in [0, 1)².
  Vec3 sample(const Vec2& u) const {
    Vec3 x, y;
    orthonormal_basis(axis, &x, &y);
    const float h = u.x * one_minus_cos;                        // 1 - cos
    const float s = std::sqrt(std::max(0.0f, h * (2.0f - h)));  // sin
    const float phi = 2.0f * kPi * u.y;
    return glm::normalize(x * (s * std::cos(phi)) + y * (s * std::sin(phi)) + axis * (1.0f - h));
  }

  // Returns the largest cosine between `normal` and a direction of the cone, clamped at 0. If the surface transmits,
  // directions on its back count by the magnitude of their cosine. A zero normal means none, for which it returns 1.
  float highest_cosine(const Vec3& normal, bool transmits) const {
    if (normal == Vec3(0.0f)) return 1.0f;
    float cosine = glm::dot(normal, axis);
    if (transmits) cosine = std::fabs(cosine);
    const float c = 1.0f - one_minus_cos;
    const float highest = cosine > c ? 1.0f : cosine * c + std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) * sine();
    return std::max(highest, 0.0f);
  }
};

}  // namespace gradus
