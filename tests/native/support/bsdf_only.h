// A second path tracer, for the truth: it follows BSDF samples until they meet something that shines, and knows nothing
// of light sampling, weights, roulette, halves or pixel filters. It shares with the library what other tests check:
// intersection, shading, BSDF sampling.
#pragma once

#include <functional>
#include <string>

#include "integrator/integrator.h"
#include "support/chi_square.h"

namespace gradus::test {

// One sample of a pixel, box filter. Bounces are limited by max_bounces alone; surfaces must be opaque.
Rgb bsdf_only_sample(const integrator::IntegratorContext& context, int x, int y, testing::Random* random);

// The same, light by light: the path's word (contract 3.1), and what it adds.
using FoundLight = std::function<void(const std::string& path, const Rgb& light)>;
void bsdf_only_path(const integrator::IntegratorContext& context, int x, int y, testing::Random* random,
                    const FoundLight& found_light);

}  // namespace gradus::test
