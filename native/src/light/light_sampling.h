// Sampling of everything that emits towards surfaces: analytic lights, emissive triangles and the world.
//
// A LightPoint is independent of the receiver. A shift can therefore copy it and evaluate its density from the offset
// path's vertex, where the same random numbers would give a different point.
#pragma once

#include <vector>

#include "base/types.h"
#include "geometry/light_links.h"

namespace gradus::geometry {
struct SurfacePoint;
}  // namespace gradus::geometry
namespace gradus::shading {
struct RayState;
}  // namespace gradus::shading

namespace gradus::light {

class LitScene;
struct LightChoice;  // light/light_table.h

enum class LightKind : uint8_t { None, AnalyticLight, Triangle, World };

// A light sample: a point of an emitter, or a direction towards an emitter at infinity.
struct LightPoint {
  LightKind kind = LightKind::None;
  bool dirac = false;  // The emitter is a single position or direction, without extent.
  // False: BSDF sampling can never find the point (a Dirac light, or a light without multiple importance sampling).
  bool found_by_rays = true;
  uint32_t index = 0;              // Index in LightTable::analytic_lights or LightTable::triangles.
  uint32_t instance = UINT32_MAX;  // Instance of an emissive triangle.
  uint32_t triangle = UINT32_MAX;  // Index of an emissive triangle in its mesh.
  // Triangle: barycentric coordinates. Facing disk: coordinates on the unit disk. World: position on Environment's map.
  Vec2 barycentric = Vec2(0.0f);
  // Position on a finite emitter. A facing disk turns towards its receiver, so that its position depends on the
  // receiver: use the direction and distance of the LightEvaluation.
  Vec3 position = Vec3(0.0f);
  Vec3 normal = Vec3(0.0f);     // Geometric normal; 0 for point lights and at infinity.
  Vec3 direction = Vec3(0.0f);  // Unit direction towards the emitter, for the world and suns.
  float error = 0.0f;           // Bound on the rounding error of `position` along the normal.
  float time = 0.0f;            // Shutter time, equal to that of the receiver's ray.

  // Returns whether the emitter is the world or a sun.
  bool at_infinity() const {
    return kind == LightKind::World ||
           (kind == LightKind::AnalyticLight && normal == Vec3(0.0f) && direction != Vec3(0.0f));
  }
};

// A light sample as seen from a receiver.
struct LightEvaluation {
  Vec3 direction = Vec3(0.0f);  // Unit direction from the receiver to the light sample.
  float distance = kInfinity;   // Distance from the receiver; infinite for the world and suns.
  // Radiance towards the receiver. For a Dirac light, the integrand without a density: intensity/d² (point) or
  // irradiance (sun).
  Rgb radiance = Rgb(0.0f);
  // Density in solid angle at the receiver, including the probability of the emitter. For a Dirac light, only that
  // probability.
  float pdf = 0.0f;
  float cosine = 1.0f;  // |normal·direction| at the emitter; 1 at infinity.
  bool casts_shadow = true;
  uint32_t visibility = 0;  // GradusVisibility bits of the ray kinds that see the emitter.
  uint32_t max_bounces = UINT32_MAX;
  // True: the radiance depends on the kind of ray. Then `radiance` is 1, and evaluated_radiance() returns the radiance.
  bool by_kind = false;
  uint64_t blockers = geometry::kAllSets;  // Shadow sets that block the emitter.
  bool is_unlinked = false;                // The emitter does not light the receiver's light set: it is black.
};

// A point that receives light. The normal is 0 for points without an orientation.
struct Receiver {
  Vec3 position = Vec3(0.0f);
  Vec3 normal = Vec3(0.0f);
  bool transmits = false;  // The point also receives light from behind.
  float time = 0.0f;       // Shutter time.
  // Bit of the receiver's light set; all bits: every emitter lights it.
  uint64_t light_sets = geometry::kAllSets;
  // Cache of the choice among emitters, for further calls with the same receiver; null: nothing is cached.
  LightChoice* memo = nullptr;
  // Compares the fields on which the choice among emitters depends.
  bool operator==(const Receiver& other) const {
    return position == other.position && normal == other.normal && transmits == other.transmits &&
           light_sets == other.light_sets;
  }
};

// Chooses an emitter by `choice` in [0, 1) and samples a point on it by u in [0, 1)². The point's kind is None if no
// emitter reaches the receiver. `view` receives the result of evaluate_light(), which costs less here because the
// choice and its probability are computed together. One exception: the radiance is 0 if the light comes from behind a
// receiver that does not transmit. The results are written in place, because a copy of recently written memory stalls
// the processor.
void sample_light_point(const LitScene& scene, const Receiver& receiver, float choice, const Vec2& u, LightPoint* point,
                        LightEvaluation* view);
// Evaluates a light sample for any receiver. The pdf is 0 if the point cannot be sampled from the receiver. The
// radiance is 0 if the emitter does not emit towards it.
LightEvaluation evaluate_light(const LitScene& scene, const LightPoint& point, const Receiver& receiver);
// Returns the radiance of an emissive triangle or the world towards the receiver, for a ray of the given state.
Rgb evaluated_radiance(const LitScene& scene, const LightPoint& point, const LightEvaluation& view,
                       const shading::RayState& ray);
// Returns only the pdf of evaluate_light(), for weights where the radiance is known or not needed.
float light_point_pdf(const LitScene& scene, const LightPoint& point, const Receiver& receiver);
// Returns whether a light sample is a direction of a world that is the same in every direction. Such a world is sampled
// or left to BSDF sampling as it pays (LightTable::factors), so that both techniques must see the same light.
bool is_of_uniform_world(const LitScene& scene, const LightPoint& point);
// Returns the origin of the shadow ray from the surface point `from` to a light sample in a direction.
Vec3 shadow_ray_origin(const LitScene& scene, const geometry::SurfacePoint& from, const LightPoint& to,
                       const Vec3& direction);
// Returns the segment from the surface point `from` to a light sample. Both ends are offset from their surfaces;
// `start` is the offset origin of the ray.
Ray ray_to_light(const Vec3& start, const geometry::SurfacePoint& from, const LightPoint& to,
                 const LightEvaluation& view);
// Returns the light sample at a surface point that a ray hit; its kind is None if the surface is not sampled as a
// light.
LightPoint light_point_of_surface(const LitScene& scene, const geometry::SurfacePoint& point);
// Returns the light sample for a ray that left the scene; its kind is None if the world is black.
LightPoint light_point_of_world(const LitScene& scene, const Vec3& direction);

// Returns the links of an emitter.
geometry::EmitterLinks links_of(const LitScene& scene, const LightPoint& point);
// Returns the light group of an emitter as the index + 1 of a channel of the scene, or 0 if it is in none.
uint32_t light_group_of(const LitScene& scene, const LightPoint& point);

// An intersection of a ray with an analytic light.
struct LightHit {
  LightPoint point;
  float distance;
};
// Replaces `hits` by the intersections of a ray with all lights that have extent, sorted by distance. Analytic lights
// do not stop rays, so that a ray crosses every light between t_min and t_max. Suns with extent are hit at infinite
// distance if t_max is infinite.
void intersect_lights(const LitScene& scene, const Ray& ray, std::vector<LightHit>* hits);

}  // namespace gradus::light
