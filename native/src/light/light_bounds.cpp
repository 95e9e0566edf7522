#include "light/light_bounds.h"

#include <algorithm>
#include <cmath>

namespace gradus::light {

namespace {

float clamped_acos(float c) { return std::acos(std::clamp(c, -1.0f, 1.0f)); }

// Any unit vector at right angles to a unit vector.
Vec3 perpendicular(const Vec3& v) {
  return glm::normalize(std::fabs(v.x) > 0.7f ? glm::cross(v, Vec3(0, 1, 0)) : glm::cross(v, Vec3(1, 0, 0)));
}

// `from` turned towards `to` by an angle, in their plane.
Vec3 turn(const Vec3& from, const Vec3& to, float angle) {
  Vec3 side = to - from * glm::dot(from, to);
  const float length = glm::length(side);
  side = length > 1e-5f ? side / length : perpendicular(from);
  return glm::normalize(from * std::cos(angle) + side * std::sin(angle));
}

// Smallest cone around both cones (as pbrt-v4's DirectionCone, section 3.8.4).
void unite_cones(const LightBounds& a, const LightBounds& b, LightBounds* out) {
  // The axis of a two-sided emitter has no sign: take the one nearer to the other cone.
  const Vec3 b_axis = b.two_sided && glm::dot(a.axis, b.axis) < 0.0f ? -b.axis : b.axis;
  // The frequent case when a group is gathered: a single normal that lies within the cone, or a cone that is full
  // already.
  const float cos_between = glm::dot(a.axis, b_axis);
  out->axis = a.axis;
  out->cos_normals = std::min(a.cos_normals, b.cos_normals);
  if (a.cos_normals <= -1.0f || b.cos_normals <= -1.0f || (b.cos_normals >= 1.0f && cos_between >= a.cos_normals))
    return;
  const float angle_a = clamped_acos(a.cos_normals), angle_b = clamped_acos(b.cos_normals);
  const float between = clamped_acos(cos_between);
  out->axis = angle_a >= angle_b ? a.axis : b_axis;
  if (std::min(between + std::min(angle_a, angle_b), kPi) <= std::max(angle_a, angle_b)) return;
  const float angle = (angle_a + between + angle_b) * 0.5f;
  if (angle >= kPi) {
    out->cos_normals = -1.0f;
    return;
  }
  out->axis = turn(a.axis, b_axis, angle - angle_a);
  out->cos_normals = std::cos(angle);
}

}  // namespace

LightBounds unite(const LightBounds& a, const LightBounds& b) {
  if (a.lower.x > a.upper.x) return b;
  if (b.lower.x > b.upper.x) return a;
  LightBounds u;
  u.lower = glm::min(a.lower, b.lower);
  u.upper = glm::max(a.upper, b.upper);
  u.power = a.power + b.power;
  u.two_sided = a.two_sided || b.two_sided;
  u.cos_emission = std::min(a.cos_emission, b.cos_emission);
  unite_cones(a, b, &u);
  // A flipped one-sided axis would be wrong; it is only flipped against a two-sided one, and then the union is
  // two-sided.
  return u;
}

float orientation_cost(const LightBounds& b, float stretch) {
  const float normals = clamped_acos(b.cos_normals), emission = clamped_acos(b.cos_emission);
  const float all = std::min(normals + emission, kPi);
  const float sin_normals = std::sin(normals);
  const float solid_angle =
      2 * kPi * (1 - b.cos_normals) +
      kPi / 2 * (2 * all * sin_normals - std::cos(normals - 2 * all) - 2 * normals * sin_normals + b.cos_normals);
  const Vec3 d = b.upper - b.lower;
  const float area = 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
  // Length beside area, so that lights on a line or in one point still differ.
  return b.power * solid_angle * stretch * (area + 1e-3f * glm::dot(d, d));
}

}  // namespace gradus::light
