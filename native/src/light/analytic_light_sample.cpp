// Sampling of analytic lights, and the density with which a given point would be sampled. Both derive from the same
// receiver-dependent quantities.
#include <algorithm>
#include <cmath>

#include "base/cone.h"
#include "base/orthonormal_basis.h"
#include "light/analytic_light.h"
#include "light/lit_part.h"
#include "light/spherical_rectangle.h"

namespace gradus::light {

namespace {

Vec2 uniform_disk(const Vec2& u) {
  const float r = std::sqrt(u.x), phi = 2.0f * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi)};
}

// Returns 1 - cos of the half angle that a sphere subtends at the receiver. From inside the sphere it is 2, because all
// directions are sampled.
float sphere_one_minus_cos(const AnalyticLight& light, const Vec3& to_centre) {
  const float sine2 = light.radius * light.radius / glm::dot(to_centre, to_centre);
  if (!(sine2 < 1.0f)) return 2.0f;
  return sine2 / (1.0f + std::sqrt(1.0f - sine2));
}

// Returns the normal at a point of a sphere's visible side, sampled uniformly in solid angle (pbrt-v4 section 6.2.4).
// The computation uses the angle at the sphere's centre, because a difference of points would cancel for a small or
// distant sphere.
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

// Samples a direction uniformly from a point inside the sphere, and returns the normal where it leaves the sphere.
Vec3 sample_normal_from_inside(const AnalyticLight& light, const Vec3& to_centre, const Vec2& u) {
  const Vec3 direction = Cone{Vec3(0, 0, 1), 2.0f}.sample(u);
  const float middle = glm::dot(to_centre, direction);
  const Vec3 closest = to_centre - direction * middle;
  const float half_chord = std::sqrt(std::max(0.0f, light.radius * light.radius - glm::dot(closest, closest)));
  return glm::normalize(direction * half_chord - closest);
}

void sample_sphere(const AnalyticLight& light, const Vec3& from, const Vec2& u, LightPoint* point) {
  const Vec3 to_centre = light.position - from;
  const float one_minus_cos = sphere_one_minus_cos(light, to_centre);
  point->normal = one_minus_cos < 2.0f ? sample_visible_normal(glm::normalize(to_centre), one_minus_cos, u)
                                       : sample_normal_from_inside(light, to_centre, u);
  point->position = light.position + point->normal * light.radius;
}

Vec3 facing_disk_position(const AnalyticLight& light, const Vec3& from, const Vec2& on_disk, Vec3* normal) {
  const Vec3 to_receiver = from - light.position;
  const float distance = glm::length(to_receiver);
  *normal = distance > 0.0f ? to_receiver / distance : Vec3(0, 0, 1);
  Vec3 x, y;
  orthonormal_basis(*normal, &x, &y);
  return light.position + light.radius * (x * on_disk.x + y * on_disk.y);
}

// Converts between points of an area light and their coordinates along its axes.
Vec3 on_light(const AnalyticLight& light, const Vec2& p) {
  return light.position + light.axis_x * p.x + light.axis_y * p.y;
}
Vec2 along_axes(const AnalyticLight& light, const Vec3& position) {
  const Vec3 offset = position - light.position;
  return Vec2(glm::dot(offset, light.axis_x), glm::dot(offset, light.axis_y));
}

SphericalRectangle seen_from(const AnalyticLight& light, const LitPart& part, const Vec3& from) {
  return SphericalRectangle(on_light(light, part.centre), light.axis_x, light.axis_y, part.half_extent.x,
                            part.half_extent.y, from);
}

// Samples a rectangular or elliptical light.
bool sample_flat(const AnalyticLight& light, const Vec3& from, const Vec2& u, LightPoint* point, float* solid_angle) {
  const LitPart part = lit_part(light, from);
  point->normal = light.emission_direction;
  Vec2 p = part.centre + part.half_extent * (2.0f * u - 1.0f);
  if (part.shape == LitPart::Shape::None) return false;
  if (part.shape == LitPart::Shape::Circle) p = part.sample_circle(u);
  if (part.shape == LitPart::Shape::Ellipse) p = part.half_extent * uniform_disk(u);
  point->position = on_light(light, p);
  if (part.shape == LitPart::Shape::Rectangle) {
    const SphericalRectangle seen = seen_from(light, part, from);
    *solid_angle = seen.sampled_solid_angle();
    if (seen.usable()) point->position = seen.sample(u);
  }
  if (!is_finite(part.radius)) return true;
  // A circle may reach beyond the light, and a rectangle beyond the circle or an ellipse.
  const Vec2 sampled = along_axes(light, point->position);
  const bool is_rectangle = light.shape == AnalyticLight::Shape::Rectangle;
  const bool may_miss =
      part.shape == LitPart::Shape::Circle || (part.shape == LitPart::Shape::Rectangle && !is_rectangle);
  return part.is_seen(sampled) && (!may_miss || light.covers(sampled));
}

// Returns the density of a point in solid angle. `to_solid_angle` converts a density in 1/m² to it. `solid_angle`: as
// for evaluate_analytic_light().
float density_of_flat(const AnalyticLight& light, const Vec3& from, const Vec3& position, float to_solid_angle,
                      const float* solid_angle) {
  if (solid_angle != nullptr && *solid_angle > 0.0f) return 1.0f / *solid_angle;
  const LitPart part = lit_part(light, from);
  switch (part.shape) {
    case LitPart::Shape::None:
      return 0.0f;
    case LitPart::Shape::Circle:
      return to_solid_angle * part.circle_density(along_axes(light, position));
    case LitPart::Shape::Ellipse:
      return to_solid_angle / light.area;
    case LitPart::Shape::Rectangle:
      break;
  }
  const float angle = solid_angle != nullptr ? 0.0f : seen_from(light, part, from).sampled_solid_angle();
  return angle > 0.0f ? 1.0f / angle : to_solid_angle / (4.0f * part.half_extent.x * part.half_extent.y);
}

}  // namespace

bool sample_analytic_light(const AnalyticLight& light, const Vec3& from, const Vec2& u, LightPoint* point,
                           float* solid_angle) {
  *solid_angle = 0.0f;
  point->kind = LightKind::AnalyticLight;
  point->dirac = light.dirac();
  point->found_by_rays = light.found_by_rays();
  switch (light.shape) {
    case AnalyticLight::Shape::Point:
      point->position = light.position;
      return true;
    case AnalyticLight::Shape::Sphere:
      sample_sphere(light, from, u, point);
      return true;
    case AnalyticLight::Shape::FacingDisk:
      // The disk turns towards each receiver. Only the coordinates on the disk are independent of the receiver.
      point->barycentric = uniform_disk(u);
      point->position = facing_disk_position(light, from, point->barycentric, &point->normal);
      return true;
    case AnalyticLight::Shape::Rectangle:
    case AnalyticLight::Shape::Ellipse:
      return sample_flat(light, from, u, point, solid_angle);
    case AnalyticLight::Shape::Direction:
      point->direction = -light.emission_direction;
      return true;
    case AnalyticLight::Shape::Cone:
      point->direction = Cone{-light.emission_direction, light.one_minus_cos_sun}.sample(u);
      return true;
  }
  return false;
}

namespace {

// Returns the fraction of a spot's strength along a direction away from it (Cycles' kernel/light/spot.h: smoothstep
// over the blend).
float spot_falloff(const AnalyticLight& light, const Vec3& leaving) {
  if (!light.is_spot) return 1.0f;
  const float cosine = glm::normalize(light.spot_space * leaving).z;
  if (!(cosine > light.cos_cone)) return 0.0f;
  const float t = std::min((cosine - light.cos_cone) * light.cone_slope, 1.0f);
  const float factor = light.spot_cosine ? std::max(glm::dot(leaving, light.emission_direction), 0.0f) : 1.0f;
  return t * t * (3.0f - 2.0f * t) * factor;
}

// Returns the factor by which an area light's limited spread scales its radiance in a direction to the light. The
// tangent comes from a cross product, because 1 - cos² has no digits left for the narrowest spreads.
float spread_falloff(const AnalyticLight& light, const Vec3& normal, const Vec3& direction, float cosine) {
  if (!is_finite(light.tan_spread)) return 1.0f;
  const float tangent = glm::length(glm::cross(normal, direction)) / cosine;
  return std::max((light.tan_spread - tangent) * light.spread_scale, 0.0f);
}

void view_at_infinity(const AnalyticLight& light, const LightPoint& point, LightEvaluation* view) {
  view->direction = point.direction;
  view->radiance = light.intensity;
  view->pdf = light.shape == AnalyticLight::Shape::Cone ? 1.0f / (2.0f * kPi * light.one_minus_cos_sun) : 1.0f;
}

void view_sphere(const AnalyticLight& light, const Vec3& normal, const Vec3& from, LightEvaluation* view) {
  const Vec3 to_centre = light.position - from;
  const float one_minus_cos = sphere_one_minus_cos(light, to_centre);
  const float cosine = -glm::dot(normal, view->direction);
  view->cosine = std::fabs(cosine);
  if (one_minus_cos < 2.0f && cosine <= 0.0f) return;  // The point is on the far side of the sphere.
  view->pdf = 1.0f / (2.0f * kPi * one_minus_cos);
  view->radiance = light.intensity * spot_falloff(light, -view->direction);
}

void view_flat(const AnalyticLight& light, const Vec3& position, const Vec3& normal, const Vec3& from,
               const float* solid_angle, LightEvaluation* view) {
  const float cosine = -glm::dot(normal, view->direction);
  if (!(cosine > 0.0f)) return;
  view->cosine = cosine;
  const float falloff = spread_falloff(light, normal, view->direction, cosine),
              to_solid_angle = view->distance * view->distance / cosine;
  if (!(falloff > 0.0f)) return;
  if (light.shape == AnalyticLight::Shape::FacingDisk)
    view->pdf = to_solid_angle / light.area;
  else
    view->pdf = density_of_flat(light, from, position, to_solid_angle, solid_angle);
  if (view->pdf > 0.0f) view->radiance = light.intensity * falloff * spot_falloff(light, -view->direction);
}

}  // namespace

void evaluate_analytic_light(const AnalyticLight& light, const LightPoint& point, const Vec3& from,
                             const float* solid_angle, LightEvaluation* view) {
  view->casts_shadow = light.casts_shadow;
  view->visibility = light.visibility;
  view->max_bounces = light.max_bounces;
  if (light.at_infinity()) return view_at_infinity(light, point, view);
  Vec3 position = point.position, normal = point.normal;
  if (light.shape == AnalyticLight::Shape::FacingDisk)
    position = facing_disk_position(light, from, point.barycentric, &normal);
  const Vec3 to_light = position - from;
  const float distance = glm::length(to_light);
  if (!(distance > 0.0f)) return;
  view->distance = distance;
  view->direction = to_light / distance;
  if (light.shape == AnalyticLight::Shape::Point) {
    view->radiance = light.intensity * (spot_falloff(light, -view->direction) / (distance * distance));
    view->pdf = 1.0f;
  } else if (light.shape == AnalyticLight::Shape::Sphere) {
    view_sphere(light, normal, from, view);
  } else {
    view_flat(light, position, normal, from, solid_angle, view);
  }
}

}  // namespace gradus::light
