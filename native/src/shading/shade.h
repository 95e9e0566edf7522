// Shading: runs the node program of a material at a surface point, on the background or on a light.
#pragma once

#include <vector>

#include "base/types.h"
#include "bsdf/closures.h"
#include "geometry/object_data.h"
#include "geometry/surface.h"

namespace gradus::shading {

class ShadedScene;
class ClosureTape;

// The kind of the ray that arrives, as bits. The Light Path node reads them.
enum RayFlag : uint32_t {
  kRayCamera = 1,
  kRayDiffuse = 2,
  kRayGlossy = 4,
  kRaySingular = 8,  // scattered by a Dirac lobe
  kRayReflection = 16,
  kRayTransmission = 32,
  kRayShadow = 64,
  kRayDiffuseAncestor = 128,  // some event since the camera was diffuse
  // Surfaces do not reflect, or refract, light in glossy lobes towards the ray: it is diffuse, and caustics are off.
  kRayWithoutReflections = 256,
  kRayWithoutRefractions = 512,
};

// The history of the ray that arrives, for the Light Path node.
struct RayState {
  uint32_t flags = kRayCamera;
  float length = 0.0f;
  uint16_t depth = 0;
  uint16_t diffuse_depth = 0;
  uint16_t glossy_depth = 0;
  uint16_t transmission_depth = 0;
  uint16_t transparent_depth = 0;
  uint16_t portal_depth = 0;
  uint16_t glass_depth = 0;   // number of first events through which the film's background shows (path/scatter.h)
  float pixel_angle = 0.0f;   // angle of a pixel, or its share of an orthographic picture; 0 shows images in full
  float blur = 0.0f;          // minimum alpha of the lobes that the ray meets, by Filter Glossy (path/filter_glossy.h)
  float guided_ratio = 1.0f;  // density of the path's directions over that without a guide (guide/guiding_field.h)
  uint32_t random = 0;        // key of the path's sample, for nodes that draw random numbers; 0: there is no path
};

// A colour and a value that a material gives to an AOV.
struct AovOutput {
  uint32_t channel = 0;  // index in the channels of the scene
  Rgb color = Rgb(0.0f);
  float value = 0.0f;
};

// A portal of a surface: rays that meet the surface continue at another place.
struct RayPortal {
  Rgb weight = Rgb(0.0f);    // black without a portal
  Vec3 origin = Vec3(0.0f);  // in internal space
  Vec3 direction = Vec3(0, 0, 1);
  bool is_elsewhere = false;  // the origin is not that of the surface
};

struct ShadeResult {
  bsdf::Closures closures;       // finished closures
  Rgb emission = Rgb(0.0f);      // radiance towards wo
  Rgb transparency = Rgb(0.0f);  // weight of the ray that continues straight through the surface
  Rgb holdout = Rgb(0.0f);
  RayPortal portal;
  bool fallback = false;                   // the material has a replaced node
  bool is_faulty = false;                  // a value was left out, because it is not finite
  bool complete = false;                   // the closures have been evaluated
  bool ignores_wo = false;                 // a complete result is equal for all directions on this side
  ClosureTape* tape = nullptr;             // records the closures for shade_from_tape(); not owned, may be null
  std::vector<AovOutput>* aovs = nullptr;  // receives outputs to AOVs; not owned, may be null

  // Returns the share of a ray that continues, straight or through a portal.
  float passed() const { return mean_component(transparency + portal.weight); }
  // Returns the share of a ray that does not continue, in [0, 1].
  Rgb opacity() const { return glm::clamp(Rgb(1.0f) - transparency - portal.weight, 0.0f, 1.0f); }
};

// Shades a surface point completely. `wo` points towards the previous vertex. `roughness_threshold` is the alpha that
// separates rough from specular classes.
void shade_surface(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo, const RayState& ray,
                   float roughness_threshold, ShadeResult* result);
// Evaluates only emission, transparency and holdout, for a path that ends here. The result is not complete unless these
// require the whole program; shade_surface() completes it.
void shade_without_closures(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                            const RayState& ray, float roughness_threshold, ShadeResult* result);
// Has the result of shade_surface(), for a point that has been shaded for `known_wo` and recorded on a tape.
void shade_from_tape(const ShadedScene& scene, const geometry::SurfacePoint& point, const ClosureTape& tape,
                     const Vec3& known_wo, const Vec3& wo, const RayState& ray, float roughness_threshold,
                     ShadeResult* result);
// Returns the emission alone, for points that light sampling has chosen.
Rgb shade_emission(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo, const RayState& ray);
// Returns the transparency alone, for shadow rays. Portals are opaque to them, as in Cycles.
Rgb shade_transparency(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                       const RayState& ray);
// Returns the outputs to AOVs, until the thread's next call of a function of this file.
const std::vector<AovOutput>& shade_aovs(const ShadedScene& scene, const geometry::SurfacePoint& point, const Vec3& wo,
                                         const RayState& ray);
// Returns those of the background in a direction in the same way.
const std::vector<AovOutput>& shade_world_aovs(const ShadedScene& scene, const Vec3& direction, const RayState& ray);
// Returns the radiance of the background in a direction that points away from the scene.
Rgb shade_world(const ShadedScene& scene, const Vec3& direction, const RayState& ray);

// A point of a light.
struct LightShadingPoint {
  Vec3 position = Vec3(0.0f);
  Vec3 normal = Vec3(0, 0, 1);
  Vec3 wo = Vec3(0, 0, 1);  // towards the receiver
  Vec2 uv = Vec2(0.0f);     // coordinates on the light's surface
  const geometry::ObjectData* object = nullptr;
  bool is_object = true;   // nodes read more of the object than a random number and normals
  bool has_uv_map = true;  // nodes find `uv` as a UV map
};
// Returns the factor by which the node program multiplies the light's strength. `material` is an index in the scene.
Rgb shade_light(const ShadedScene& scene, uint32_t material, const LightShadingPoint& point, const RayState& ray);

}  // namespace gradus::shading
