// Scattering of a base path: class first, then direction (contract 1.4); bounce limits and Russian roulette.
#pragma once

#include "path/segment.h"

namespace gradus::path {

// What a path carries from vertex to vertex.
struct PathState {
  PathRay ray;
  Rgb throughput = Rgb(1.0f);
  int depth = 0;                // scatterings so far
  bool emission_only = false;   // the bounce limits are reached: the next vertex shows its emission and no more
  lpe::LpeState lpe_state = 0;  // of the scatterings so far
};

// All that the path's last ray may have to show are lights and the world.
inline bool shows_only_lights(const PathContext& context, const PathState& state) {
  return state.emission_only && context.scene.features.only_lights_emit;
}

// A sampled scattering event, as a shift must know it.
struct ScatterEvent {
  bsdf::ScatterClass scatter_class = bsdf::ScatterClass::Diffuse;
  bsdf::BsdfSample sample;
  float pdf = 0.0f;        // P(class)·p(direction | class); for Dirac events of the choice alone
  bool by_kind = false;    // the kind of bounce is part of what is sampled: factor is that of its lobes alone
  int dirac_rank = 0;      // the sampled Dirac lobe's number among those of its class
  Rgb factor = Rgb(0.0f);  // value / pdf: what the throughput was multiplied with
  // P(kind | direction) within the class.
  float kind_share() const { return sample.kind.pdf / sample.pdf; }
};

// GradusVisibility bit of the bounce.
uint32_t bounce_visibility(bsdf::LightPass pass, bool transmitted);

// Russian roulette at a vertex, after its emission was seen and before it is lit: what a ray finds does not suffer from
// the roulette's variance. Cycles' rule: from the third vertex on, by the square root of the largest channel, which
// matches a display's curve roughly. 0: the path ends; otherwise the probability, by which the throughput was divided.
float survive(const VertexSample& u, PathState* state);

// The class that a vertex scatters by for a random number; false: it scatters nothing.
bool choose_class(const bsdf::Closures& closures, float u, bsdf::ScatterClass* chosen);

// Samples the next direction. False: absorbed. Otherwise state->ray, throughput and depth are those of the new
// segment.
bool scatter(const PathContext& context, const VertexSample& u, const Vertex& vertex, PathState* state,
             ScatterEvent* event);

// The state of the ray that leaves a vertex by such a bounce.
shading::RayState next_ray_state(const shading::RayState& state, bool diffuse, bool transmitted, bool dirac);
// The new segment's ray for a given direction; also for shifted paths, whose rays look like those of their base.
void follow(const PathContext& context, const geometry::SurfacePoint& from, const Vec3& direction, bsdf::LightPass pass,
            bool transmitted, bool dirac, PathRay* ray);

}  // namespace gradus::path
