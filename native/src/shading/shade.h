// From a hit to closures: runs the material's node program at a surface point.
#pragma once

#include "base/types.h"
#include "bsdf/closures.h"
#include "geometry/surface.h"

namespace gradus::shading {

class ShadedScene;
class ClosureTape;

// Kind of ray that arrives: what the Light Path node sees.
enum RayFlag : uint32_t {
  kRayCamera = 1,
  kRayDiffuse = 2,
  kRayGlossy = 4,
  kRaySingular = 8,  // Dirac
  kRayReflection = 16,
  kRayTransmission = 32,
  kRayShadow = 64,
};

struct RayState {
  uint32_t flags = kRayCamera;
  float length = 0.0f;
  uint16_t depth = 0;
  uint16_t diffuse_depth = 0;
  uint16_t glossy_depth = 0;
  uint16_t transmission_depth = 0;
  uint16_t transparent_depth = 0;
};

struct ShadeResult {
  bsdf::Closures closures;       // finished
  Rgb emission = Rgb(0.0f);      // radiance towards wo
  Rgb transparency = Rgb(0.0f);  // weight of the ray that goes straight on
  Rgb holdout = Rgb(0.0f);
  bool fallback = false;    // the material holds a replaced node
  bool complete = false;    // the closures are there; then:
  bool ignores_wo = false;  // all of this is the same seen from anywhere on this side
  ClosureTape* tape =
      nullptr;  // not owned: if there is one, shade_surface() records the closures for shade_from_tape()
};

// wo: towards the previous vertex. roughness_threshold: alpha that separates classes.
void shade_surface(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo, const RayState& ray,
                   float roughness_threshold, ShadeResult* result);
// What a ray sees before anything is scattered, which a path that ends here needs alone: without closures where the
// surface is opaque. shade_surface() adds them.
void shade_without_closures(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                            const RayState& ray, float roughness_threshold, ShadeResult* result);
// As shade_surface(), for a point that was shaded with a tape for `known_wo`.
void shade_from_tape(const ShadedScene& scene, const geometry::SurfacePoint& point, const ClosureTape& tape,
                     const Vec3& known_wo, const Vec3& wo, const RayState& ray, float roughness_threshold,
                     ShadeResult* result);
// Emission alone, for emitter points that light sampling chose.
Rgb shade_emission(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo, const RayState& ray);
// Transparency alone, for shadow rays.
Rgb shade_transparency(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                       const RayState& ray);
// Background radiance from a direction (pointing away from the scene).
Rgb shade_world(const ShadedScene& scene, const Vec3& direction, const RayState& ray);

// A point of a light: what the light's program multiplies its strength by. material: index in the scene. uv: on its
// surface.
struct LightShadingPoint {
  Vec3 position = Vec3(0.0f);
  Vec3 normal = Vec3(0, 0, 1);
  Vec3 wo = Vec3(0, 0, 1);  // towards the receiver
  Vec2 uv = Vec2(0.0f);
  Mat3 axes{1.0f};  // of the light, without scale
};
Rgb shade_light(const ShadedScene& scene, uint32_t material, const LightShadingPoint& point, const RayState& ray);

}  // namespace gradus::shading
