#include "light/light_bounds.h"

#include <algorithm>
#include <cmath>

namespace gradus::light {

namespace {

float clamped_acos(float c) { return std::acos(std::clamp(c, -1.0f, 1.0f)); }

// Returns any unit vector perpendicular to the unit vector v.
Vec3 perpendicular(const Vec3& v) {
  return glm::normalize(std::fabs(v.x) > 0.7f ? glm::cross(v, Vec3(0, 1, 0)) : glm::cross(v, Vec3(1, 0, 0)));
}

// Returns `from` rotated by `angle` towards `to`, in their common plane.
Vec3 turn(const Vec3& from, const Vec3& to, float angle) {
  Vec3 side = to - from * glm::dot(from, to);
  const float length = glm::length(side);
  side = length > 1e-5f ? side / length : perpendicular(from);
  return glm::normalize(from * std::cos(angle) + side * std::sin(angle));
}

// Sets the axis and angle of `out` to the smallest cone that contains both cones (pbrt-v4's DirectionCone,
// section 3.8.4).
void unite_cones(const LightBounds& a, const LightBounds& b, LightBounds* out) {
  // The axis of a two-sided emitter has no sign. The sign nearer to the other cone gives the smaller union.
  const Vec3 b_axis = b.two_sided && glm::dot(a.axis, b.axis) < 0.0f ? -b.axis : b.axis;
  // This is the frequent case when the bounds of a group are accumulated: b is a single normal within the cone of a, or
  // one of the cones is already the full sphere.
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
  u.receivers = a.receivers | b.receivers;
  u.cos_emission = std::min(a.cos_emission, b.cos_emission);
  unite_cones(a, b, &u);
  // Flipping the axis of a one-sided emitter would be wrong. unite_cones() flips only the axis of two-sided bounds, and
  // then the union is two-sided.
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
  // The squared diagonal is added to the area, so that boxes without area (lights on a line) still have different
  // costs.
  return b.power * solid_angle * stretch * (area + 1e-3f * glm::dot(d, d));
}

}  // namespace gradus::light
