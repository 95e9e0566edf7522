// A second path tracer, for the truth: it follows BSDF samples until they meet something that shines, and knows nothing of light sampling,
// weights, roulette, halves or pixel filters. It shares with the library what other tests check: intersection, shading, BSDF sampling.
#pragma once

#include "integrator/integrator.h"
#include "support/chi_square.h"

namespace gradus::test {

// One sample of a pixel, box filter. Bounces are limited by max_bounces alone; surfaces must be opaque.
Rgb bsdf_only_sample(const IntegratorContext& context, int x, int y, testing::Random* random);

}  // namespace gradus::test
