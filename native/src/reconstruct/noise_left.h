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

// `images` have halves. NONE: of the noisy image itself.
NoiseLeft noise_left(const GradientImages& images, uint32_t reconstruction, float alpha, const CancelTest& cancel);

// The same of L2 alone: above what WEIGHTED and L1 leave, whose weights follow the noise and hide some of it from the estimate, too.
std::vector<float> noise_left_by_l2(const GradientImages& images, float alpha, const CancelTest& cancel);

}  // namespace gradus
