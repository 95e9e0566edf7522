// Reconstruction of one image from a noisy primal image and its sampled gradients.
//
// A solver first estimates weights from the images, W = estimate(images), then applies x = W(planes). W is a frozen
// linear operator, so that alpha can go through the same weights. Results do not depend on the number of threads.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "reconstruct/solve_report.h"

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
