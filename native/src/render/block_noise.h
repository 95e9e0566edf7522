// Estimates the error of an image in pixel blocks. Adaptive sampling stops blocks and shares samples by it.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"

namespace gradus::render {

struct BlockNoise {
  // Root of the mean squared error over the mean squared gray, of the reconstruction that will be delivered. The noise
  // threshold is compared with this value.
  double relative_error = 0.0;
  // Root of the mean over pixels of the squared error over the squared gray, by the weights of that reconstruction. It
  // is used to compare blocks. For L1, whose weights follow the noise, it is up to ten times too small.
  double spread = 0.0;
};

// Estimates the noise of each of `blocks`, which lie in the film's region. `reconstruction` is the one that will be
// delivered: GRADUS_RECONSTRUCTION_NONE if the film has no gradients and it needs them.
std::vector<BlockNoise> estimate_noise(const film::Film& film, const std::vector<Region>& blocks,
                                       uint32_t reconstruction, float alpha, const CancelCheck& cancel);

}  // namespace gradus::render
