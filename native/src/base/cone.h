// A cone of directions, sampled uniformly: suns, and spheres seen from afar.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/orthonormal_basis.h"

namespace gradus {

struct Cone {
  Vec3 axis = Vec3(0, 0, 1);
  float one_minus_cos = 0.0f;  // of the half angle: small ones keep their digits

  bool contains(const Vec3& direction) const {
    const Vec3 d = direction - axis;
    return glm::dot(d, d) <= 2.0f * one_minus_cos;
  }
  float solid_angle() const { return 2.0f * kPi * one_minus_cos; }
  // Of half the angle.
  float sine() const { return std::sqrt(std::max(0.0f, one_minus_cos * (2.0f - one_minus_cos))); }

  Vec3 sample(const Vec2& u) const {
    Vec3 x, y;
    orthonormal_basis(axis, &x, &y);
    const float h = u.x * one_minus_cos;                        // 1 - cos
    const float s = std::sqrt(std::max(0.0f, h * (2.0f - h)));  // sin
    const float phi = 2.0f * kPi * u.y;
    return glm::normalize(x * (s * std::cos(phi)) + y * (s * std::sin(phi)) + axis * (1.0f - h));
  }

  // Largest cosine to a normal among the directions, not below 0; transmits: on either side. No normal: 1.
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
