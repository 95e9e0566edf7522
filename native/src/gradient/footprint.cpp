#include "gradient/footprint.h"

#include <algorithm>

namespace gradus::gradient {

bool is_parallax_below(const Vec3& x, const Vec3& y, const Vec3& z, float angle) {
  const Vec3 across = x - y, from_x = z - x, from_y = z - y;
  return glm::dot(across, across) < angle * angle * std::min(glm::dot(from_x, from_x), glm::dot(from_y, from_y));
}

bool is_short_edge(const Vec3& x, const Vec3& y, const Vec3& z) { return !is_parallax_below(x, y, z, 1.0f); }

bool shares_specular_vertex(const Vec3& x, const Vec3& y, const Vec3& z, float curvature, bool transmission) {
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

}  // namespace gradus::gradient
