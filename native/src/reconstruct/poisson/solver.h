// Reconstruction of one image from a noisy primal image and its sampled gradients.
//
// A solver first estimates weights from the images, W = estimate(images), then applies x = W(planes). W is a frozen
// linear operator, so that alpha can go through the same weights. Results do not depend on the number of threads.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"

namespace gradus::reconstruct {

// One channel to reconstruct.
struct PoissonPlanes {
  const float* primal = nullptr;
  const float* dx = nullptr;
  const float* dy = nullptr;
  size_t stride = 1;  // distance in floats from pixel to pixel, for interleaved channels
};

inline PoissonPlanes planes_of(const film::GradientImages& images, int channel) {
  return {images.primal.data() + channel, images.dx.data() + channel, images.dy.data() + channel,
          size_t(images.channels)};
}

struct SolveReport {
  int outer_steps = 0;
  int inner_steps = 0;
  float residual = 0.0f;  // norm of the residual over that of the right side; maximum over all solves
  bool hit_cap = false;   // whether a solve ended at its maximum number of steps before it converged
};

// Returns α, the weight of the primal image against the gradients; `alpha` 0 selects the value with the smallest
// measured error. Offset paths that meet other surfaces than their base paths give noisy differences, so L2 needs a
// larger α than the thesis's 0.2. L1's weights adapt to that noise by themselves.
inline float chosen_alpha(uint32_t reconstruction, float alpha) {
  return alpha > 0.0f ? alpha : reconstruction == GRADUS_RECONSTRUCTION_L2 ? 0.4f : 0.2f;
}

// Reconstructs all channels of `images` and returns width·height·channels values. `reconstruction` is
// GRADUS_RECONSTRUCTION_L2 or GRADUS_RECONSTRUCTION_L1. L2 is unbiased. L1 is followed by twicing (twicing.h); its
// weights are estimated from the first three channels together, and a fourth one uses them, too. It is consistent, not
// unbiased. Throws `unsupported` for other reconstructions.
std::vector<float> reconstruct(const film::GradientImages& images, uint32_t reconstruction, float alpha,
                               const CancelCheck& cancel, SolveReport* report);

// Reconstructs one component of a film, from the images that film::read_images() returns for it.
std::vector<float> reconstruct(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                               const CancelCheck& cancel, SolveReport* report);

}  // namespace gradus::reconstruct
