// A random walk in the medium below a surface, from the point at which light enters an object to the point at which it
// leaves.
//
// Each step has one of up to nine techniques, combined by the balance heuristic: distances by the extinction of one
// colour channel; directions by the phase function, or guided out of the medium, towards the surface at which the walk
// has started or an opposite one. Guided steps follow the zero-variance walk of a half-space (Dwivedi 1982; Křivánek
// and d'Eon 2014, "A Zero-Variance-Based Sampling Scheme for Monte Carlo Subsurface Scattering"; Meng, Hanika and
// Dachsbacher 2016, "Improving the Dwivedi Sampling Scheme"; d'Eon and Křivánek 2020, "Zero-Variance Theory for
// Efficient Subsurface Scattering"). As in Cycles, a walk ends after 256 steps, and steps behind the tenth are
// isotropic, with the extinction of a similar medium.
#pragma once

#include "bsdf/subsurface.h"
#include "path/context.h"

namespace gradus::path {

struct WalkStart {
  Vec3 position = Vec3(0.0f);  // on the surface
  float nearest = 0.0f;        // distance along the first step within which rounding finds the surface itself
  Vec3 direction = Vec3(0.0f);
  Vec3 normal = Vec3(0, 0, 1);  // out of the object
  uint32_t instance = 0;
  float time = 0.0f;
};

struct WalkEnd {
  geometry::Hit hit;
  Vec3 direction = Vec3(0.0f);  // of the last step
};

// Walks from `start` to a surface of the same instance. `depth` is the number of scattering events of the path before.
// Multiplies `weight` by the weight of the walk. The colour of `weight` guides the walk, so that equal arguments give
// equal walks. Returns false if the walk does not end at a surface.
bool walk(const PathContext& context, const Sampler& sampler, int depth, const bsdf::Medium& medium,
          const WalkStart& start, Rgb* weight, WalkEnd* end);

}  // namespace gradus::path
