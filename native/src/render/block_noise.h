// The error of a picture's cells: what stops them and what shares samples between them.
#pragma once

#include <vector>

#include "film/film.h"
#include "reconstruct/solver.h"

namespace gradus::render {

struct BlockNoise {
  // Root of mean squared error over mean squared gray, of the reconstruction that will be delivered: what the threshold
  // is set against (contract 5.3).
  double relative_error = 0.0;
  // Root of the mean over pixels of squared error over squared gray, by the weights of that reconstruction. It tells
  // cells apart, but of L1, whose weights follow the noise, it is up to ten times too small.
  double spread = 0.0;
};

// Cells of the frame's region. reconstruction: of what will be delivered; NONE where the frame has no gradients.
std::vector<BlockNoise> estimate_noise(const film::Film& film, const std::vector<Region>& blocks,
                                       uint32_t reconstruction, float alpha, const CancelCheck& cancel);

}  // namespace gradus::render
