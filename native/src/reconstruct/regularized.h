// REGULARIZED: the features of the frame, its samples and, where there are any, its sampled differences.
#pragma once

#include "reconstruct/reconstructed.h"
#include "reconstruct/solver.h"

namespace gradus {

// With its error, always. Throws invalid_operation for a frame without features.
Reconstructed regularize(const Frame& frame, int component, const CancelTest& cancel, SolveReport* report);

}  // namespace gradus
