// A second path tracer as reference: it follows BSDF samples until they meet an emitter, without light sampling,
// weights, Russian roulette, half-buffers or pixel filters. It shares with the library what other tests check:
// intersection, shading, BSDF sampling.
#pragma once

#include <functional>
#include <string>

#include "integrator/integrator.h"
#include "support/chi_square.h"

namespace gradus::test {

// Samples a pixel once with a box filter. Bounces are limited by max_bounces alone; surfaces must be opaque.
Rgb bsdf_only_sample(const integrator::IntegratorContext& context, int x, int y, test::Random* random);

// Called for each contribution: the path as a string of events, and the light that it adds.
using FoundLight = std::function<void(const std::string& path, const Rgb& light)>;
void bsdf_only_path(const integrator::IntegratorContext& context, int x, int y, test::Random* random,
                    const FoundLight& found_light);

}  // namespace gradus::test
