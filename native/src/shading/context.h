// What a node program knows of the point it runs at.
#pragma once

#include <array>

#include "base/types.h"
#include "geometry/surface.h"
#include "shading/shade.h"
#include "shading/shaded_scene.h"

namespace gradus::image {
class ImageStore;
}  // namespace gradus::image

namespace gradus::shading {

struct ShadeContext {
  const ShadedScene* scene = nullptr;  // nullptr: estimates without a scene
  const image::ImageStore* images = nullptr;
  const geometry::InstanceData* instance = nullptr;  // nullptr: world and lights
  geometry::Hit hit;
  Vec3 position = Vec3(0.0f);             // internal space; world: the direction
  Vec3 normal = Vec3(0, 0, 1);            // shading normal, turned as the geometric normal is
  Vec3 geometric_normal = Vec3(0, 0, 1);  // on the side of wo
  Vec3 wo = Vec3(0, 0, 1);
  Vec2 uv = Vec2(0.0f);              // of lights
  const Mat3* light_axes = nullptr;  // nullptr: no light
  RayState ray;
  bool backfacing = false;
  bool is_background = false;
  bool mean_textures = false;  // estimates: images give their mean colour
};

ShadeContext surface_context(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                             const RayState& ray);
ShadeContext background_context(const ShadedScene& scene, const Vec3& direction, const RayState& ray);
ShadeContext light_context(const ShadedScene& scene, const LightShadingPoint& point, const RayState& ray);

// Of the instance at the time of the hit.
const geometry::Placement& placement_of(const ShadeContext& context, geometry::Placement* room);
// Position in world space; the direction for backgrounds.
Vec3 world_position(const ShadeContext& context);
// Corners of the triangle in internal space, and the context moved along the surface by `step`: interpolated values
// follow it.
std::array<Vec3, 3> world_corners(const ShadeContext& context);
ShadeContext moved_context(const ShadeContext& context, const std::array<Vec3, 3>& corners, const Vec3& step);
// Directions and normals between spaces of the object; without an object they stay.
Vec3 normal_to_local(const ShadeContext& context, const Vec3& normal);
Vec3 normal_to_world(const ShadeContext& context, const Vec3& normal);

}  // namespace gradus::shading
