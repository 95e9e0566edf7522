// What a path adds to its pixel, one emitter at a time.
#pragma once

#include "path/light.h"

namespace gradus::path {

// throughput·tail, clamped. The tail holds all that lies behind the throughput (scattering in next-event estimation,
// radiance, weight); a path that shares it only has another throughput.
struct Contribution {
  Rgb clamped = Rgb(0.0f);
  Rgb tail = Rgb(0.0f);
  Rgb light = Rgb(0.0f);   // of the tail: what a ray found; in next-event estimation the transmittance
  float pdf_light = 0.0f;  // of the techniques that could have found the emitter, in solid angle
  float pdf_bsdf = 0.0f;
  bool indirect = false;
  int component = 0;
};

// The path passes a segment.
void apply_segment(const Segment& segment, PathState* state);

// Emitters that the path's ray found: state before apply_segment() for lights, after it for the others.
Contribution light_hit_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                    const LightCrossing& light_crossing);
Contribution world_contribution(const PathContext& context, const RaySource& source, const PathState& state);
Contribution emission_contribution(const PathContext& context, const RaySource& source, const PathState& state,
                                   const Vertex& vertex);

// Next-event estimation. False: no class scatters the light.
bool light_classes(const PathContext& context, const Vertex& vertex, const LightSample& light,
                   const shading::RayState& ray, LitClass lit[bsdf::kScatterClasses]);
Contribution light_contribution(const PathContext& context, const PathState& state, const LightSample& light,
                                bsdf::ScatterClass scatter_class, const LitClass& lit, const Rgb& transmittance);

// The surface is cut out of the film.
bool is_holdout(const PathContext& context, const Vertex& vertex);
// Part of the film that a surface with holdout leaves transparent.
float holdout_alpha(const Rgb& throughput, const Rgb& holdout);

}  // namespace gradus::path
