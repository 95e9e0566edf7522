// Intersection of rays with lights that have extent.
#include <algorithm>
#include <cmath>

#include "base/orthonormal_basis.h"
#include "light/analytic_light.h"
#include "light/light_scene.h"
#include "light/light_table.h"
#include "light/lit_scene.h"

namespace gradus::light {

namespace {

bool within(const Ray& ray, float t) { return t > ray.t_min && t < ray.t_max; }

bool hit_sphere(const AnalyticLight& light, const Ray& ray, LightPoint* point, float* distance) {
  const Vec3 to_centre = light.position - ray.origin;
  const float middle = glm::dot(to_centre, ray.direction);
  const Vec3 closest = to_centre - ray.direction * middle;
  const float squared_half_chord = light.radius * light.radius - glm::dot(closest, closest);
  if (!(squared_half_chord >= 0.0f)) return false;
  const bool inside = glm::dot(to_centre, to_centre) < light.radius * light.radius;
  *distance = inside ? middle + std::sqrt(squared_half_chord) : middle - std::sqrt(squared_half_chord);
  if (!within(ray, *distance)) return false;
  point->normal = glm::normalize(ray.direction * *distance - to_centre);
  point->position = light.position + point->normal * light.radius;
  return true;
}

bool hit_plane(const Ray& ray, const Vec3& position, const Vec3& normal, float* distance, Vec3* offset) {
  const float cosine = glm::dot(ray.direction, normal);
  if (!(cosine < 0.0f)) return false;  // Flat lights emit from one side only.
  *distance = glm::dot(position - ray.origin, normal) / cosine;
  if (!within(ray, *distance)) return false;
  *offset = ray.origin + ray.direction * *distance - position;
  return true;
}

bool hit_facing_disk(const AnalyticLight& light, const Ray& ray, LightPoint* point, float* distance) {
  const Vec3 to_origin = ray.origin - light.position;
  const float length = glm::length(to_origin);
  if (!(length > 0.0f)) return false;
  point->normal = to_origin / length;
  Vec3 offset, x, y;
  if (!hit_plane(ray, light.position, point->normal, distance, &offset)) return false;
  orthonormal_basis(point->normal, &x, &y);
  point->barycentric = Vec2(glm::dot(offset, x), glm::dot(offset, y)) / light.radius;
  point->position = light.position + offset;
  return glm::dot(point->barycentric, point->barycentric) <= 1.0f;
}

// Combines all conditions into one branch at the end, without short-circuit evaluation. The processor cannot predict on
// which side a ray passes the light, but it can predict that the ray misses, which is nearly always true.
bool hit_flat(const AnalyticLight& light, const Ray& ray, LightPoint* point, float* distance) {
  const float cosine = glm::dot(ray.direction, light.emission_direction);
  *distance = glm::dot(light.position - ray.origin, light.emission_direction) / cosine;
  const Vec3 offset = ray.origin + ray.direction * *distance - light.position;
  const float x = glm::dot(offset, light.axis_x), y = glm::dot(offset, light.axis_y);
  const bool inside = light.shape == AnalyticLight::Shape::Ellipse
                          ? light.covers(Vec2(x, y))
                          : int(std::fabs(x) <= light.half_width) & int(std::fabs(y) <= light.half_height);
  if (!(int(cosine < 0.0f) & int(*distance > ray.t_min) & int(*distance < ray.t_max) & int(inside))) return false;
  point->normal = light.emission_direction;
  point->position = light.position + offset;
  return true;
}

bool hit_cone(const AnalyticLight& light, const Ray& ray, LightPoint* point, float* distance) {
  if (ray.t_max != kInfinity || !Cone{-light.emission_direction, light.one_minus_cos_sun}.contains(ray.direction))
    return false;
  point->direction = ray.direction;
  *distance = kInfinity;
  return true;
}

}  // namespace

bool intersect_light(const AnalyticLight& light, const Ray& ray, LightPoint* point, float* distance) {
  point->kind = LightKind::AnalyticLight;
  switch (light.shape) {
    case AnalyticLight::Shape::Sphere:
      return hit_sphere(light, ray, point, distance);
    case AnalyticLight::Shape::FacingDisk:
      return hit_facing_disk(light, ray, point, distance);
    case AnalyticLight::Shape::Rectangle:
    case AnalyticLight::Shape::Ellipse:
      return hit_flat(light, ray, point, distance);
    case AnalyticLight::Shape::Cone:
      return hit_cone(light, ray, point, distance);
    case AnalyticLight::Shape::Point:
    case AnalyticLight::Shape::Direction:
      break;
  }
  return false;
}

void intersect_lights(const LitScene& scene, const Ray& ray, std::vector<LightHit>* hits) {
  hits->clear();
  const LightScene* analytic_lights = scene.light_table->lights_with_extent.get();
  if (analytic_lights) analytic_lights->intersect(scene.light_table->analytic_lights, ray, hits);
}

}  // namespace gradus::light
