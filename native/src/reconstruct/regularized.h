// REGULARIZED: the features of the frame, its samples and, where there are any, its sampled differences.
#pragma once

#include "frame/features.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solver.h"

namespace gradus {

// What a component is regressed on, as filter_features() leaves it: its own features, or those of the frame.
Features features_of(const Frame& frame, int component);
// With its error, always. Throws invalid_operation for a frame without features.
Reconstructed regularize(const Frame& frame, int component, const CancelTest& cancel, SolveReport* report);
// The same by its features as filter_features() leaves them.
Reconstructed regularize(const Frame& frame, int component, const Features& features, const CancelTest& cancel, SolveReport* report);

}  // namespace gradus
