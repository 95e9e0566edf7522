#include "shading/context.h"

#include <cfloat>

#include "geometry/mesh.h"
#include "shading/faulty_materials.h"
#include "shading/scalar.h"

namespace gradus::shading {

ShadeContext surface_context(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                             const RayState& ray) {
  ShadeContext c;
  c.scene = &scene;
  c.images = scene.images.get();
  c.instance = &scene.instances[point.hit.instance];
  c.material = point.material;
  c.hit = point.hit;
  c.position = point.position;
  c.backfacing = glm::dot(point.geometric_normal, wo) < 0.0f;
  c.normal = c.backfacing ? -point.shading_normal : point.shading_normal;
  c.geometric_normal = c.backfacing ? -point.geometric_normal : point.geometric_normal;
  c.wo = wo;
  c.ray = ray;
  return c;
}

ShadeContext background_context(const ShadedScene& scene, const Vec3& direction, const RayState& ray) {
  ShadeContext c;
  c.scene = &scene;
  c.images = scene.images.get();
  c.material = scene.world_material;
  c.position = direction;
  c.normal = c.geometric_normal = c.wo = -direction;
  c.ray = ray;
  c.is_background = true;
  return c;
}

ShadeContext light_context(const ShadedScene& scene, const LightShadingPoint& point, const RayState& ray) {
  ShadeContext c;
  c.scene = &scene;
  c.images = scene.images.get();
  c.position = point.position;
  c.normal = c.geometric_normal = point.normal;
  c.wo = point.wo;
  c.light = &point;
  c.ray = ray;
  return c;
}

void note_fault(const ShadeContext& c) {
  if (c.scene != nullptr && c.scene->faulty_materials) c.scene->faulty_materials->add(c.material);
}

const geometry::ObjectData* object_of(const ShadeContext& c) {
  if (c.instance) return c.instance;
  return c.light && c.light->is_object ? c.light->object : nullptr;
}

const geometry::Placement& placement_of(const ShadeContext& c, geometry::Placement* storage) {
  if (!c.instance) return *c.light->object;
  return c.instance->placement(c.hit.time, storage);
}

float camera_distance(const ShadeContext& c) {
  if (!c.scene->has_camera) return c.scene->radius;
  const GradusCamera& camera = c.scene->camera;
  if (camera.type == GRADUS_CAMERA_ORTHOGRAPHIC) return camera.window[1] - camera.window[0];
  const float* m = camera.matrix;
  return glm::distance(c.position, Vec3(m[12], m[13], m[14]));
}

Vec3 world_position(const ShadeContext& c) {
  return c.is_background || !c.scene ? c.position : c.position + c.scene->origin;
}

ShadeContext moved_context(const ShadeContext& context, const geometry::SurfaceDerivatives& derivatives,
                           const Vec3& step) {
  ShadeContext c = context;
  c.center = &context;
  c.position += step;
  const Vec2 duv = derivatives.duv(step);
  c.hit.uv += context.backfacing ? -duv : duv;
  return c;
}

const ShadeContext& center_of(const ShadeContext& c) { return c.center ? center_of(*c.center) : c; }

Vec3 normal_to_local(const ShadeContext& c, const Vec3& normal) {
  // Normals map to local space by the transpose of the object's matrix, the inverse of the matrix of normals.
  geometry::Placement storage;
  if (!c.instance && !c.light) return normal;
  return safe_normalize(glm::transpose(Mat3(placement_of(c, &storage).to_world)) * normal);
}

Vec3 normal_to_world(const ShadeContext& c, const Vec3& normal) {
  geometry::Placement storage;
  return object_of(c) ? safe_normalize(placement_of(c, &storage).normal_to_world * normal) : normal;
}

}  // namespace gradus::shading
