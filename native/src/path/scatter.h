// Scattering of a base path: class first, then direction (contract 1.4); bounce limits and Russian roulette.
#pragma once

#include "path/segment.h"

namespace gradus {

// What a path carries from vertex to vertex.
struct PathState {
  PathRay ray;
  Rgb throughput = Rgb(1.0f);
  int depth = 0;               // scatterings so far
  bool emission_only = false;  // the bounce limits are reached: the next vertex shows its emission and no more
};

// A sampled scattering event, as a shift must know it.
struct ScatterEvent {
  ScatterClass scatter_class = ScatterClass::Diffuse;
  BsdfSample sample;
  float pdf = 0.0f;        // P(class)·p(direction | class); for Dirac events of the choice alone
  float survival = 1.0f;   // of Russian roulette
  int dirac_rank = 0;      // the sampled Dirac lobe's number among those of its class
  Rgb factor = Rgb(0.0f);  // value / (pdf·survival): what the throughput was multiplied with
};

// GradusVisibility bit of the bounce.
uint32_t bounce_visibility(LightPass pass, bool transmitted);

// Samples the next direction. False: absorbed, or ended by roulette. Otherwise state->ray, throughput and depth are those of the new
// segment.
bool scatter(const PathContext& context, const Sampler& sampler, const Vertex& vertex, PathState* state, ScatterEvent* event);

// The new segment's ray for a given direction; also for shifted paths, whose rays look like those of their base.
void follow(const PathContext& context, const SurfacePoint& from, const Vec3& direction, LightPass pass, bool transmitted, bool dirac,
            PathRay* ray);

}  // namespace gradus
