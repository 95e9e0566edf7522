// Estimates the noise that L1 leaves, from the difference of the two half-buffers (contract 1.2). The weights are those
// of the measured noise (minimise_by_noise.h), which are close to L1's and need no iteration.
#pragma once

#include <vector>

#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// Images of GradientImages' layout: W(p_A/2 + p_B/2) and W(p_A/2 − p_B/2) of the planes p of both halves. W follows the
// noise and hides a part of it from the second, whose squares tell pixels apart, but say too little (error_estimate.h).
struct NoiseLeft {
  std::vector<float> image, noise;
};

// images: with deviations; half_differences: of the same frame (read_half_differences()). Channels beyond the third,
// which have no part in the weights, stay 0.
NoiseLeft noise_left(const film::GradientImages& images, const film::GradientImages& half_differences, float alpha,
                     const CancelCheck& cancel);

}  // namespace gradus::reconstruct
