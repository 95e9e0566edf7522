// Estimates the noise that remains after L1, from the difference of the two half-buffers. The weights are those of the
// measured noise (minimise_by_noise.h), which are close to L1's and need no iteration.
#pragma once

#include <vector>

#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// `image` is W(p_A/2 + p_B/2) and `noise` is W(p_A/2 − p_B/2), where p are the planes of each half-buffer; both have
// the layout of GradientImages. W depends on the noise and so hides a part of it from `noise`: the squares of `noise`
// compare pixels well, but are too small (error_estimate.h).
struct RemainingNoise {
  std::vector<float> image, noise;
};

// `images` must have deviations; `half_differences` belong to the same film (film::read_half_differences()). Channels
// beyond the third do not take part in the weights and stay 0.
RemainingNoise remaining_noise(const film::GradientImages& images, const film::GradientImages& half_differences,
                               float alpha, const CancelCheck& cancel);

}  // namespace gradus::reconstruct
