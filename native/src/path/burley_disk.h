// Subsurface scattering by the profile of Christensen and Burley 2015 ("Approximate Reflectance Profiles for Efficient
// Subsurface Scattering"), sampled by rays through disks around the point at which light enters (King, Kulla, Conty and
// Fajardo 2013, "BSSRDF Importance Sampling").
#pragma once

#include "path/random_walk.h"
#include "path/scatter.h"

namespace gradus::path {

// Returns the profile over distances in two dimensions, 2πr times Burley's, at distance r for the scale d. It is cut
// off at kDiskReach·d and integrates to 1.
float burley_profile(float d, float r);
// Samples a distance in units of the scale by the profile.
float sample_burley(float u);
inline constexpr float kDiskReach = 16.0f;

// Chooses a point of the entry's instance near the entry. Sets its hit, and a direction out of the object as the last
// one of a walk. Multiplies `weight` by the weight of the point. Returns false if there is none.
bool probe_disk(const PathContext& context, const Sampler& sampler, const VertexSample& u, int depth,
                const Vertex& entry, const bsdf::Lobe& lobe, WalkEnd* end, Rgb* weight);

}  // namespace gradus::path
