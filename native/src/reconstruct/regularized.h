// REGULARIZED: the features of the frame, its samples and, where there are any, its sampled differences.
#pragma once

#include "reconstruct/solver.h"

namespace gradus {

struct Regularized {
  std::vector<float> image;  // width·height·channels
  std::vector<float> error;  // width·height: estimated squared error of the image, mean over RGB
};

// Throws invalid_operation for a frame without features.
Regularized regularize(const Frame& frame, int component, const CancelTest& cancel, SolveReport* report);

}  // namespace gradus
