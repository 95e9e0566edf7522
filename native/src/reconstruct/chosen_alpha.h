// The weight of the sampled image in reconstructions from gradients.
#pragma once

#include <cstdint>

#include "gradus/gradus.h"

namespace gradus::reconstruct {

// Returns α, the weight of the primal image against the gradients; `alpha` 0 selects the value with the smallest
// measured error. Offset paths that meet other surfaces than their base paths give noisy differences, so L2 needs a
// larger α than the thesis's 0.2. L1's weights adapt to that noise by themselves.
inline float chosen_alpha(uint32_t reconstruction, float alpha) {
  return alpha > 0.0f ? alpha : reconstruction == GRADUS_RECONSTRUCTION_L2 ? 0.4f : 0.2f;
}

}  // namespace gradus::reconstruct
