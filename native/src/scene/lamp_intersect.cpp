// Rays against lamps with extent.
#include <algorithm>
#include <cmath>

#include "scene/emitter_table.h"
#include "scene/frame_basis.h"
#include "scene/lamp.h"
#include "scene/lamp_scene.h"
#include "scene/lit_scene.h"

namespace gradus {

namespace {

bool within(const Ray& ray, float t) { return t > ray.t_min && t < ray.t_max; }

bool hit_sphere(const Lamp& lamp, const Ray& ray, EmitterPoint* point, float* distance) {
  const Vec3 to_centre = lamp.position - ray.origin;
  const float middle = glm::dot(to_centre, ray.direction);
  const Vec3 closest = to_centre - ray.direction * middle;
  const float rest = lamp.radius * lamp.radius - glm::dot(closest, closest);
  if (!(rest >= 0.0f)) return false;
  const bool inside = glm::dot(to_centre, to_centre) < lamp.radius * lamp.radius;
  *distance = inside ? middle + std::sqrt(rest) : middle - std::sqrt(rest);
  if (!within(ray, *distance)) return false;
  point->normal = glm::normalize(ray.direction * *distance - to_centre);
  point->position = lamp.position + point->normal * lamp.radius;
  return true;
}

bool hit_plane(const Ray& ray, const Vec3& position, const Vec3& normal, float* distance, Vec3* offset) {
  const float cosine = glm::dot(ray.direction, normal);
  if (!(cosine < 0.0f)) return false;  // one-sided
  *distance = glm::dot(position - ray.origin, normal) / cosine;
  if (!within(ray, *distance)) return false;
  *offset = ray.origin + ray.direction * *distance - position;
  return true;
}

bool hit_facing_disk(const Lamp& lamp, const Ray& ray, EmitterPoint* point, float* distance) {
  const Vec3 to_origin = ray.origin - lamp.position;
  const float length = glm::length(to_origin);
  if (!(length > 0.0f)) return false;
  point->normal = to_origin / length;
  Vec3 offset, x, y;
  if (!hit_plane(ray, lamp.position, point->normal, distance, &offset)) return false;
  orthonormal_basis(point->normal, &x, &y);
  point->barycentric = Vec2(glm::dot(offset, x), glm::dot(offset, y)) / lamp.radius;
  point->position = lamp.position + offset;
  return glm::dot(point->barycentric, point->barycentric) <= 1.0f;
}

bool within_ellipse(const Lamp& lamp, float x, float y) {
  const float u = x / lamp.half_width, v = y / lamp.half_height;
  return u * u + v * v <= 1.0f;
}

// One test at the end: on which side a ray passes the lamp cannot be foretold, that it misses nearly always can.
bool hit_flat(const Lamp& lamp, const Ray& ray, EmitterPoint* point, float* distance) {
  const float cosine = glm::dot(ray.direction, lamp.shine);
  *distance = glm::dot(lamp.position - ray.origin, lamp.shine) / cosine;
  const Vec3 offset = ray.origin + ray.direction * *distance - lamp.position;
  const float x = glm::dot(offset, lamp.axis_x), y = glm::dot(offset, lamp.axis_y);
  const bool inside = lamp.shape == Lamp::Shape::Ellipse ? within_ellipse(lamp, x, y)
                                                         : int(std::fabs(x) <= lamp.half_width) & int(std::fabs(y) <= lamp.half_height);
  if (!(int(cosine < 0.0f) & int(*distance > ray.t_min) & int(*distance < ray.t_max) & int(inside))) return false;
  point->normal = lamp.shine;
  point->position = lamp.position + offset;
  return true;
}

bool hit_cone(const Lamp& lamp, const Ray& ray, EmitterPoint* point, float* distance) {
  if (ray.t_max != kInfinity || !Cone{-lamp.shine, lamp.one_minus_cos_sun}.contains(ray.direction)) return false;
  point->direction = ray.direction;
  *distance = kInfinity;
  return true;
}

}  // namespace

bool intersect_lamp(const Lamp& lamp, const Ray& ray, EmitterPoint* point, float* distance) {
  point->kind = EmitterKind::Lamp;
  switch (lamp.shape) {
    case Lamp::Shape::Sphere:
      return hit_sphere(lamp, ray, point, distance);
    case Lamp::Shape::FacingDisk:
      return hit_facing_disk(lamp, ray, point, distance);
    case Lamp::Shape::Rectangle:
    case Lamp::Shape::Ellipse:
      return hit_flat(lamp, ray, point, distance);
    case Lamp::Shape::Cone:
      return hit_cone(lamp, ray, point, distance);
    case Lamp::Shape::Point:
    case Lamp::Shape::Direction:
      break;
  }
  return false;
}

void intersect_lamps(const LitScene& scene, const Ray& ray, std::vector<LampHit>* hits) {
  hits->clear();
  const LampScene* lamps = scene.emitters->lamps_with_extent.get();
  if (lamps) lamps->intersect(scene.emitters->lamps, ray, hits);
}

}  // namespace gradus
