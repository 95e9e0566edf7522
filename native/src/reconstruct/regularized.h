// REGULARIZED: the features of the frame, its samples and, where there are any, its sampled differences.
#pragma once

#include "frame/features.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solver.h"

namespace gradus {

// With its error, always. Throws invalid_operation for a frame without features.
Reconstructed regularize(const Frame& frame, int component, const CancelTest& cancel, SolveReport* report);
// The same by its features as filter_features() leaves them.
Reconstructed regularize(const Frame& frame, int component, const Features& features, const CancelTest& cancel, SolveReport* report);

}  // namespace gradus
