// REGULARIZED: the features of the frame, its samples and, where there are any, its sampled differences.
#pragma once

#include "film/features.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// With its error, always. Throws invalid_operation for a frame without features.
// by_components: what becomes of each of them, too. All go through one operator, that of their sum, so that they are
// what the picture is made of, however it was found (contract 3.4).
Reconstructed regularize(const film::Film& film, bool by_components, const CancelCheck& cancel, SolveReport* report);
// The same by its features, filtered.
Reconstructed regularize(const film::Film& film, const film::Features& features, bool by_components,
                         const CancelCheck& cancel, SolveReport* report);

}  // namespace gradus::reconstruct
