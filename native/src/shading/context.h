// The inputs of a node program: the point that is shaded and the ray that arrives there.
#pragma once

#include "base/types.h"
#include "geometry/surface.h"
#include "shading/shade.h"
#include "shading/shaded_scene.h"

namespace gradus::image {
class ImageStore;
}  // namespace gradus::image

namespace gradus::shading {

struct ShadeContext {
  const ShadedScene* scene = nullptr;  // null for estimates without a scene
  const image::ImageStore* images = nullptr;
  const geometry::InstanceData* instance = nullptr;  // null for the world and for lights
  uint32_t material = UINT32_MAX;                    // index in the scene
  geometry::Hit hit;
  Vec3 position = Vec3(0.0f);             // in internal space; the direction for the world
  Vec3 normal = Vec3(0, 0, 1);            // shading normal, flipped together with the geometric normal
  Vec3 geometric_normal = Vec3(0, 0, 1);  // on the side of wo
  Vec3 wo = Vec3(0, 0, 1);
  const LightShadingPoint* light = nullptr;  // null for other points
  Vec2 uv = Vec2(0.0f);                      // UV coordinates of an estimate
  // The shaded point, if this one is a neighbour whose height a bump compares with that of the shaded point.
  const ShadeContext* center = nullptr;
  RayState ray;
  bool backfacing = false;
  bool is_background = false;
  bool mean_textures = false;  // makes images return their mean colour, for estimates
};

// Contexts for a point of a surface, for the background in a direction that points away from the scene, and for a point
// of a light. `point` must outlive the context of a light.
ShadeContext surface_context(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                             const RayState& ray);
ShadeContext background_context(const ShadedScene& scene, const Vec3& direction, const RayState& ray);
ShadeContext light_context(const ShadedScene& scene, const LightShadingPoint& point, const RayState& ray);

// Notes in the scene that a value of the material was left out, because it is not finite.
void note_fault(const ShadeContext& context);

// Returns the object of which nodes read the properties: that of the instance, or of a light that has one for nodes.
// Null for other lights and for the background.
const geometry::ObjectData* object_of(const ShadeContext& context);
// Returns the placement of the instance at the time of the hit, or else of the light; there must be one. `storage`
// holds it if it has to be interpolated.
const geometry::Placement& placement_of(const ShadeContext& context, geometry::Placement* storage);
// Returns the length at the point of what the camera sees at an angle of 1 radian: the distance of the point. For an
// orthographic camera it is the width of the picture, and without a camera the radius of the scene.
float camera_distance(const ShadeContext& context);
// Returns the position in world space, or the direction for the background.
Vec3 world_position(const ShadeContext& context);
// Returns the context moved by `step` along the primitive of its hit, of which the derivatives are given. Interpolated
// values are those of the new point, but tangents stay those of `context`, as in Cycles. Seen from behind, interpolated
// values are those of a step in the opposite direction, as in Cycles, so that bumps of a texture with UV coordinates
// are the same bumps on both sides. `context` must outlive the result.
ShadeContext moved_context(const ShadeContext& context, const geometry::SurfaceDerivatives& derivatives,
                           const Vec3& step);
// Returns the point to which a bump compares this neighbour of it, or the context itself.
const ShadeContext& center_of(const ShadeContext& context);
// Transform normals between internal space and the object's space. Without an object they return the normal unchanged;
// the space of its normal is known of any light.
Vec3 normal_to_local(const ShadeContext& context, const Vec3& normal);
Vec3 normal_to_world(const ShadeContext& context, const Vec3& normal);

}  // namespace gradus::shading
