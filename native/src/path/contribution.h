// Contributions of a path to its pixel, one for each emitter that it finds.
#pragma once

#include "path/light.h"

namespace gradus::path {

// The contribution is throughput·tail, clamped. The tail is everything behind the throughput: the BSDF in next-event
// estimation, radiance, and the weight of multiple importance sampling. A path that shares the tail differs by its
// throughput only.
struct Contribution {
  Rgb clamped = Rgb(0.0f);
  Rgb tail = Rgb(0.0f);
  Rgb light = Rgb(0.0f);  // factor of the tail: radiance found by a ray, or transmittance in next-event estimation
  // Densities of the two techniques that could have found the emitter, in solid angle.
  float pdf_light = 0.0f;
  float pdf_bsdf = 0.0f;
  bool is_hidden = false;  // see LightVisibility
  bool indirect = false;
  int component = 0;
};

// Multiplies the throughput by the weight of a segment.
void apply_segment(const Segment& segment, PathState* state);

// Return the contribution of an emitter that the path's ray has found, black if it is not visible. `state` is that
// before apply_segment() for analytic lights, and that after it for the world and surfaces.
Contribution light_hit_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                    const LightCrossing& crossing);
Contribution world_contribution(const PathContext& context, const RaySource& source, const PathState& state);
// Returns the contribution that the world would have where a transparent film hides it. It belongs to no component.
Contribution film_background_contribution(const PathContext& context, const RaySource& source, const PathState& state);
Contribution emission_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                   const Vertex& vertex);

// Evaluates a light sample in all classes, shadows excluded. Returns whether at least one class scatters its light.
bool light_classes(const PathContext& context, const Vertex& vertex, const LightSample& light,
                   const shading::RayState& ray, LitClass lit[bsdf::kPathEvents]);
// Returns the contribution of a light sample in one class. `state` is that on arrival at the vertex.
Contribution light_contribution(const PathContext& context, const PathState& state, const LightSample& light,
                                bsdf::ScatterClass scatter_class, const LitClass& lit,
                                const LightVisibility& visibility);

// Returns whether the surface is a holdout object or a shadow catcher, which the film shows as transparent and at which
// a path ends that shows the film's background.
bool cuts_hole(const PathContext& context, const Vertex& vertex);
// Returns the part of the film that a surface with the given holdout closure leaves transparent.
float holdout_alpha(const Rgb& throughput, const Rgb& holdout);

}  // namespace gradus::path
