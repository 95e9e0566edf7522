// Scattering of a base path: BSDF sampling of a class and then of a direction, bounce limits, and Russian roulette.
#pragma once

#include <optional>

#include "path/segment.h"

namespace gradus::path {

// Returns whether a ray shows the film's background: it comes from the camera, or through clear glass alone.
inline bool shows_background(const shading::RayState& ray) { return ray.glass_depth == ray.depth; }

// State that a path carries from vertex to vertex.
struct PathState {
  PathRay ray;
  Rgb throughput = Rgb(1.0f);
  int depth = 0;                // number of scattering events so far
  bool emission_only = false;   // the bounce limits are reached: the path ends with the emission of the next vertex
  lpe::LpeState lpe_state = 0;  // light path expression state after these events
  // Returns whether the path shows the film's background, as the camera ray does: alpha is 0 where it leaves the scene
  // above a transparent film, and where it meets a hole. With Transparent Glass, clear glass does not change that.
  bool shows_background() const { return path::shows_background(ray.state); }
};

// Returns whether the path's next segment is its last and can show only analytic lights and the world.
inline bool shows_only_lights(const PathContext& context, const PathState& state) {
  return state.emission_only && context.scene.features.only_lights_emit && !state.shows_background();
}

// A sampled scattering event, with everything that a shift needs to know.
struct ScatterEvent {
  bsdf::ScatterClass scatter_class = bsdf::ScatterClass::Diffuse;
  bsdf::BsdfSample sample;
  float pdf = 0.0f;        // P(class)·p(direction | class); for Dirac events the probability of the lobe
  bool is_exit = false;    // light leaves the object here that has entered it elsewhere (subsurface.h)
  bool by_kind = false;    // the kind of the bounce is sampled, too, and `factor` is that of its lobes alone
  int dirac_rank = 0;      // index of the sampled Dirac lobe among those of its class
  Rgb factor = Rgb(0.0f);  // value / pdf, by which the throughput was multiplied
  // PathContext::glass_limit if the path shows the film's background up to here, otherwise negative.
  float glass_limit = -1.0f;
  bool is_clear = false;  // the film's background shows through the event, too
  float blur = 0.0f;      // by which Filter Glossy blurs what the next ray meets, for this event alone
  // Returns P(kind | direction) within the class.
  float kind_share() const { return sample.kind.pdf / sample.pdf; }
  // Returns the kind of the bounce if it is sampled.
  std::optional<bool> sampled_kind() const { return by_kind ? std::optional(sample.diffuse) : std::nullopt; }
};

// Returns whether the film's background shows through a smooth event of class c: as in Cycles, where glass transmits
// whose roughness is within PathContext::glass_limit. Where lobes of one class differ, what most of the light passes
// decides, so that it is a function of the path and not of the lobe that was sampled.
inline bool is_clear(float glass_limit, const Vertex& vertex, bsdf::ScatterClass c, const Vec3& wi, bool transmitted) {
  return glass_limit >= 0.0f && transmitted && vertex.shade.closures.transmits_clearly(c, vertex.wo, wi, glass_limit);
}

// Returns the GradusVisibility bit of a bounce.
uint32_t bounce_visibility(bsdf::LightPass pass, bool transmitted);

// Plays Russian roulette at a vertex, after its emission was added and before it is lit, so that emission does not
// suffer from its variance. As in Cycles, it starts at the third vertex, and the probability is the square root of the
// largest channel, which is roughly uniform on a display. The throughput is that without a guide: that of a guided path
// is low because the path leads to much light. Returns 0 if the path ends, otherwise the probability by which it has
// divided the throughput.
float survive(const VertexSample& u, PathState* state);

// Chooses the class by which a vertex scatters with a random number. Returns false if it does not scatter.
bool choose_class(const bsdf::Closures& closures, float u, bsdf::ScatterClass* chosen);

// Samples the next direction. Returns false if the path is absorbed. Otherwise updates the state to the new segment.
bool scatter(const PathContext& context, const VertexSample& u, const Vertex& vertex, PathState* state,
             ScatterEvent* event);

// Returns the state of the ray that leaves a vertex by the given kind of bounce. `diffuse_flags` are the flags of a
// diffuse ray (PathContext::diffuse_flags).
shading::RayState next_ray_state(const shading::RayState& state, bool diffuse, bool transmitted, bool dirac,
                                 uint32_t diffuse_flags);

}  // namespace gradus::path
