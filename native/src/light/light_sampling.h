// Everything that emits towards surfaces: lights, emissive triangles, the world.
//
// An LightPoint is independent of the point that is lit, so that a shift can copy it and ask for its density from the
// offset vertex (same random numbers would give another point).
#pragma once

#include <vector>

#include "base/types.h"

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

struct LightPoint {
  LightKind kind = LightKind::None;
  bool dirac = false;         // a position or direction without extent
  bool found_by_rays = true;  // false: BSDF sampling can never find it (Dirac, or a light without multiple importance)
  uint32_t index = 0;         // light, or emissive triangle
  uint32_t instance = UINT32_MAX;  // of an emissive triangle
  uint32_t triangle = UINT32_MAX;
  Vec2 barycentric =
      Vec2(0.0f);  // on the triangle; facing disk: coordinates on the unit disk; world: Environment's place
  Vec3 position =
      Vec3(0.0f);  // finite emitters; a facing disk turns with its receiver: take direction and distance of the view
  Vec3 normal = Vec3(0.0f);     // geometric; 0 for points
  Vec3 direction = Vec3(0.0f);  // towards the emitter: world and suns
  float error = 0.0f;           // bound on the rounding error of `position` along the normal
  float time = 0.0f;            // of the shutter, as the ray's that it is for
  bool at_infinity() const {
    return kind == LightKind::World ||
           (kind == LightKind::AnalyticLight && normal == Vec3(0.0f) && direction != Vec3(0.0f));
  }
};

// An emitter point as seen from a receiver.
struct LightEvaluation {
  Vec3 direction = Vec3(0.0f);  // from the receiver, unit
  float distance = kInfinity;
  Rgb radiance = Rgb(
      0.0f);  // towards the receiver; Dirac: intensity/d² (point) or irradiance (sun): the integrand without a density
  float pdf = 0.0f;     // solid angle at the receiver, choice of the emitter included; Dirac: the choice alone
  float cosine = 1.0f;  // |normal·direction| at the emitter; 1 at infinity
  bool casts_shadow = true;
  uint32_t visibility = 0;  // GradusVisibility bits: which kinds of bounce may see it
  uint32_t max_bounces = UINT32_MAX;
  bool by_kind =
      false;  // the radiance depends on the kind of ray that looks: ask evaluated_radiance(); `radiance` is 1
};

// The receiver of light; normal 0 for points without an orientation.
struct Receiver {
  Vec3 position = Vec3(0.0f);
  Vec3 normal = Vec3(0.0f);
  bool transmits = false;  // also lit from behind
  float time = 0.0f;       // of the shutter
  // Where the choice among emitters is kept for the next that asks from here; nullptr: nowhere.
  LightChoice* memo = nullptr;
  bool operator==(const Receiver& other) const {
    return position == other.position && normal == other.normal && transmits == other.transmits;
  }
};

// Samples a point on some emitter. choice: which one; u: where. kind None if there is nothing to sample from here.
// view: what evaluate_light() would give, but cheaper, because the choice is made and its probability found in one go;
// only the radiance is left out, as 0, where the light comes from behind a receiver that does not transmit. Both are
// written where the caller keeps them: copies of what has just been written stall.
void sample_light_point(const LitScene& scene, const Receiver& receiver, float choice, const Vec2& u, LightPoint* point,
                        LightEvaluation* view);
// The same point from any receiver: pdf 0 where it cannot be sampled from there, radiance 0 where it does not shine
// there.
LightEvaluation evaluate_light(const LitScene& scene, const LightPoint& point, const Receiver& receiver);
// Radiance of a triangle or the world towards the receiver, for a ray of this kind.
Rgb evaluated_radiance(const LitScene& scene, const LightPoint& point, const LightEvaluation& view,
                       const shading::RayState& ray);
// The density of evaluate_light() alone: for weights, where the radiance is known or not needed.
float light_point_pdf(const LitScene& scene, const LightPoint& point, const Receiver& receiver);
// The segment from a surface to an emitter, both ends off their surfaces; start: of the ray, beside `from`.
Ray ray_to_light(const Vec3& start, const geometry::SurfacePoint& from, const LightPoint& to,
                 const LightEvaluation& view);
// The emitter point of a surface that a ray hit (kind None if it is not sampled as a light).
LightPoint light_point_of_surface(const LitScene& scene, const geometry::SurfacePoint& point);
// The emitter point of a ray that left the scene.
LightPoint light_point_of_world(const LitScene& scene, const Vec3& direction);

// Lights do not stop rays: a ray sees all that it crosses before its hit. Calls visit(LightPoint, distance) for each
// light with extent between ray.t_min and ray.t_max, and for each sun with extent, at infinity, if ray.t_max is
// infinite.
struct LightHit {
  LightPoint point;
  float distance;
};
// Fills `hits`, sorted by distance.
void intersect_lights(const LitScene& scene, const Ray& ray, std::vector<LightHit>* hits);

}  // namespace gradus::light
