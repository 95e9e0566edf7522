// How much noise the cells of a picture have: what stops them and what shares samples between them.
#pragma once

#include <vector>

#include "frame/frame.h"
#include "reconstruct/solver.h"

namespace gradus {

struct CellNoise {
  // Root of mean squared error over mean squared gray: what the threshold is set against (contract 5.3). Of the L2 reconstruction, where
  // there is one: what WEIGHTED and L1 leave is less, but an estimate by their own weights is up to ten times too small.
  double relative_error = 0.0;
  // Root of the mean over pixels of squared error over squared gray, of the reconstruction that will be delivered. It tells cells apart.
  double spread = 0.0;
};

// Cells of the frame's region. reconstruction: of what will be delivered; NONE where the frame has no gradients.
std::vector<CellNoise> estimate_noise(const Frame& frame, const std::vector<Region>& cells, uint32_t reconstruction, float alpha,
                                      const CancelTest& cancel);

}  // namespace gradus
