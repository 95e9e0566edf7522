#include "gradient/reconnection.h"

#include <algorithm>
#include <cmath>

namespace gradus::gradient {

float light_point_jacobian(float cosine_base, float distance_base, float cosine_offset, float distance_offset) {
  const float ratio = distance_base / distance_offset;
  return cosine_offset / cosine_base * ratio * ratio;
}

bool is_parallax_below(const Vec3& x, const Vec3& y, const Vec3& z, float angle) {
  const Vec3 across = x - y, from_x = z - x, from_y = z - y;
  return glm::dot(across, across) < angle * angle * std::min(glm::dot(from_x, from_x), glm::dot(from_y, from_y));
}

bool is_short_edge(const Vec3& x, const Vec3& y, const Vec3& z) { return !is_parallax_below(x, y, z, 1.0f); }

bool shares_sharp_vertex(const Vec3& x, const Vec3& y, const Vec3& z, float curvature, bool transmission) {
  // Minimum curvature · edge. Here the directions behind z differ about equally with and without sharing.
  constexpr float kCurved = 0.5f;
  // Maximum parallax at a mirror. Above it the loss at the rim of the mirror exceeds the gain from its flatness.
  constexpr float kSmall = 0.2f;
  const float edge = std::min(glm::length(z - x), glm::length(z - y));
  return curvature * edge > kCurved ? !is_short_edge(x, y, z) : !transmission && is_parallax_below(x, y, z, kSmall);
}

bool looks_similar(const Vec3& x, const Vec3& y, const Vec3& z, float width) {
  return is_parallax_below(x, y, z, width);
}

Reconnection reconnect(const Vec3& base, const Vec3& offset, const Vec3& target, const Vec3& target_normal) {
  Reconnection result;
  const Vec3 from_base = target - base;
  const Vec3 from_offset = target - offset;
  const float distance_base = glm::length(from_base);
  result.distance = glm::length(from_offset);
  result.direction = from_offset / result.distance;
  const float cosine_base = std::fabs(glm::dot(target_normal, from_base)) / distance_base;
  const float cosine_offset = std::fabs(glm::dot(target_normal, result.direction));
  result.jacobian = light_point_jacobian(cosine_base, distance_base, cosine_offset, result.distance);
  if (!(result.jacobian > 0.0f) || !is_finite(result.jacobian)) {
    result.failure = ShiftFailure::Jacobian;
  }
  return result;
}

}  // namespace gradus::gradient
