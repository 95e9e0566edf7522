// What a reconstruction leaves of the noise, from the difference of the two half-buffers (contract 1.2).
#pragma once

#include <vector>

#include "reconstruct/solver.h"

namespace gradus {

// Images of GradientImages' layout. For a linear reconstruction W of the planes p of both halves: W(p_A/2 + p_B/2) and W(p_A/2 − p_B/2),
// whose square has the variance of the first as its mean.
struct NoiseLeft {
  std::vector<float> image, noise;
};

// images: with deviations for L1 and WEIGHTED, whose weights follow the noise and hide a part of it from this estimate. half_differences:
// of the same frame (read_half_differences()). NONE: of the noisy image itself.
NoiseLeft noise_left(const GradientImages& images, const GradientImages& half_differences, uint32_t reconstruction, float alpha,
                     const CancelTest& cancel);

}  // namespace gradus
