// Sampling of lamps, and the density with which a given point would be sampled: both from the same receiver-dependent quantities.
#include <algorithm>
#include <cmath>

#include "scene/cone.h"
#include "scene/frame_basis.h"
#include "scene/lamp.h"
#include "scene/spherical_rectangle.h"

namespace gradus {

namespace {

Vec2 uniform_disk(const Vec2& u) {
  const float r = std::sqrt(u.x), phi = 2.0f * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi)};
}

// 1 - cos of the half angle under which a sphere is seen; 2 from inside: then all directions are sampled.
float sphere_one_minus_cos(const Lamp& lamp, const Vec3& to_centre) {
  const float sine2 = lamp.radius * lamp.radius / glm::dot(to_centre, to_centre);
  if (!(sine2 < 1.0f)) return 2.0f;
  return sine2 / (1.0f + std::sqrt(1.0f - sine2));
}

// Normal of the visible side at a point sampled uniformly in solid angle (pbrt-v4 section 6.2.4): by the angle at the centre, because
// the difference of points would cancel for a small or distant sphere.
Vec3 sample_visible_normal(const Vec3& axis, float one_minus_cos, const Vec2& u) {
  const float max_sine2 = one_minus_cos * (2.0f - one_minus_cos);
  const float h = u.x * one_minus_cos;
  const float sine2 = h * (2.0f - h);
  const float ratio2 = std::min(sine2 / max_sine2, 1.0f);
  const float cosine = sine2 / std::sqrt(max_sine2) + (1.0f - h) * std::sqrt(1.0f - ratio2);
  const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  Vec3 x, y;
  orthonormal_basis(axis, &x, &y);
  const float phi = 2.0f * kPi * u.y;
  return glm::normalize((x * std::cos(phi) + y * std::sin(phi)) * sine - axis * cosine);
}

// From inside: uniform directions, and where they leave the sphere.
Vec3 sample_normal_from_inside(const Lamp& lamp, const Vec3& to_centre, const Vec2& u) {
  const Vec3 direction = Cone{Vec3(0, 0, 1), 2.0f}.sample(u);
  const float middle = glm::dot(to_centre, direction);
  const Vec3 closest = to_centre - direction * middle;
  const float half_chord = std::sqrt(std::max(0.0f, lamp.radius * lamp.radius - glm::dot(closest, closest)));
  return glm::normalize(direction * half_chord - closest);
}

void sample_sphere(const Lamp& lamp, const Vec3& from, const Vec2& u, EmitterPoint* point) {
  const Vec3 to_centre = lamp.position - from;
  const float one_minus_cos = sphere_one_minus_cos(lamp, to_centre);
  point->normal = one_minus_cos < 2.0f ? sample_visible_normal(glm::normalize(to_centre), one_minus_cos, u)
                                       : sample_normal_from_inside(lamp, to_centre, u);
  point->position = lamp.position + point->normal * lamp.radius;
}

Vec3 facing_disk_position(const Lamp& lamp, const Vec3& from, const Vec2& on_disk, Vec3* normal) {
  const Vec3 to_receiver = from - lamp.position;
  const float distance = glm::length(to_receiver);
  *normal = distance > 0.0f ? to_receiver / distance : Vec3(0, 0, 1);
  Vec3 x, y;
  orthonormal_basis(*normal, &x, &y);
  return lamp.position + lamp.radius * (x * on_disk.x + y * on_disk.y);
}

SphericalRectangle seen_from(const Lamp& lamp, const Vec3& from) {
  return SphericalRectangle(lamp.position, lamp.axis_x, lamp.axis_y, lamp.half_width, lamp.half_height, from);
}

Vec3 sample_rectangle(const Lamp& lamp, const Vec3& from, const Vec2& u, float* solid_angle) {
  const SphericalRectangle seen = seen_from(lamp, from);
  *solid_angle = seen.sampled_solid_angle();
  if (seen.usable()) return seen.sample(u);
  return lamp.position + lamp.axis_x * (lamp.half_width * (2.0f * u.x - 1.0f)) + lamp.axis_y * (lamp.half_height * (2.0f * u.y - 1.0f));
}

bool in_front(const Lamp& lamp, const Vec3& from) { return glm::dot(from - lamp.position, lamp.shine) > 0.0f; }

}  // namespace

bool sample_lamp(const Lamp& lamp, const Vec3& from, const Vec2& u, EmitterPoint* point, float* solid_angle) {
  *solid_angle = 0.0f;
  point->kind = EmitterKind::Lamp;
  point->dirac = lamp.dirac();
  point->found_by_rays = lamp.found_by_rays();
  switch (lamp.shape) {
    case Lamp::Shape::Point:
      point->position = lamp.position;
      return true;
    case Lamp::Shape::Sphere:
      sample_sphere(lamp, from, u, point);
      return true;
    case Lamp::Shape::FacingDisk:
      // The disk turns with the receiver: what stays the same from another one are the coordinates on it.
      point->barycentric = uniform_disk(u);
      point->position = facing_disk_position(lamp, from, point->barycentric, &point->normal);
      return true;
    case Lamp::Shape::Rectangle:
      if (!in_front(lamp, from)) return false;
      point->position = sample_rectangle(lamp, from, u, solid_angle);
      point->normal = lamp.shine;
      return true;
    case Lamp::Shape::Ellipse: {
      if (!in_front(lamp, from)) return false;
      const Vec2 d = uniform_disk(u);
      point->position = lamp.position + lamp.axis_x * (lamp.half_width * d.x) + lamp.axis_y * (lamp.half_height * d.y);
      point->normal = lamp.shine;
      return true;
    }
    case Lamp::Shape::Direction:
      point->direction = -lamp.shine;
      return true;
    case Lamp::Shape::Cone:
      point->direction = Cone{-lamp.shine, lamp.one_minus_cos_sun}.sample(u);
      return true;
  }
  return false;
}

namespace {

// Share of a spot's strength along a direction that leaves it (Cycles' kernel/light/spot.h: smoothstep over the blend).
float spot_falloff(const Lamp& lamp, const Vec3& leaving) {
  if (!lamp.is_spot) return 1.0f;
  const float cosine = glm::dot(leaving, lamp.shine);
  if (cosine <= lamp.cos_cone) return 0.0f;
  const float t = std::min((cosine - lamp.cos_cone) * lamp.cone_slope, 1.0f);
  return t * t * (3.0f - 2.0f * t) * (lamp.spot_cosine ? std::max(cosine, 0.0f) : 1.0f);
}

float spread_falloff(const Lamp& lamp, float cosine) {
  if (!is_finite(lamp.tan_spread)) return 1.0f;
  const float tangent = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine)) / cosine;
  return std::max((lamp.tan_spread - tangent) * lamp.spread_scale, 0.0f);
}

void view_at_infinity(const Lamp& lamp, const EmitterPoint& point, EmitterView* view) {
  view->direction = point.direction;
  view->radiance = lamp.intensity;
  view->pdf = lamp.shape == Lamp::Shape::Cone ? 1.0f / (2.0f * kPi * lamp.one_minus_cos_sun) : 1.0f;
}

void view_sphere(const Lamp& lamp, const Vec3& normal, const Vec3& from, EmitterView* view) {
  const Vec3 to_centre = lamp.position - from;
  const float one_minus_cos = sphere_one_minus_cos(lamp, to_centre);
  const float cosine = -glm::dot(normal, view->direction);
  view->cosine = std::fabs(cosine);
  if (one_minus_cos < 2.0f && cosine <= 0.0f) return;  // the far side
  view->pdf = 1.0f / (2.0f * kPi * one_minus_cos);
  view->radiance = lamp.intensity * spot_falloff(lamp, -view->direction);
}

void view_flat(const Lamp& lamp, const Vec3& normal, const Vec3& from, const float* solid_angle, EmitterView* view) {
  const float cosine = -glm::dot(normal, view->direction);
  if (!(cosine > 0.0f) || (lamp.shape != Lamp::Shape::FacingDisk && !in_front(lamp, from))) return;
  view->cosine = cosine;
  view->pdf = view->distance * view->distance / (cosine * lamp.area);
  if (lamp.shape == Lamp::Shape::Rectangle) {
    const float angle = solid_angle != nullptr ? *solid_angle : seen_from(lamp, from).sampled_solid_angle();
    if (angle > 0.0f) view->pdf = 1.0f / angle;
  }
  view->radiance = lamp.intensity * spread_falloff(lamp, cosine) * spot_falloff(lamp, -view->direction);
}

}  // namespace

void view_lamp(const Lamp& lamp, const EmitterPoint& point, const Vec3& from, const float* solid_angle, EmitterView* view) {
  view->casts_shadow = lamp.casts_shadow;
  view->visibility = lamp.visibility;
  view->max_bounces = lamp.max_bounces;
  if (lamp.at_infinity()) return view_at_infinity(lamp, point, view);
  Vec3 position = point.position, normal = point.normal;
  if (lamp.shape == Lamp::Shape::FacingDisk) position = facing_disk_position(lamp, from, point.barycentric, &normal);
  const Vec3 to_light = position - from;
  const float distance = glm::length(to_light);
  if (!(distance > 0.0f)) return;
  view->distance = distance;
  view->direction = to_light / distance;
  if (lamp.shape == Lamp::Shape::Point) {
    view->radiance = lamp.intensity * (spot_falloff(lamp, -view->direction) / (distance * distance));
    view->pdf = 1.0f;
  } else if (lamp.shape == Lamp::Shape::Sphere) {
    view_sphere(lamp, normal, from, view);
  } else {
    view_flat(lamp, normal, from, solid_angle, view);
  }
}

}  // namespace gradus
