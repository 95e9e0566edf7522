// The reconstruction REGULARIZED: regression on the features of the film, combined with its sampled differences if it
// has gradients.
#pragma once

#include "base/cancel_check.h"
#include "film/features.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/regression/regression_error.h"
#include "reconstruct/solve_report.h"

namespace gradus::reconstruct {

// Reconstructs a film and estimates the error. Throws `invalid_operation` if the film has no features. `by_components`
// requests the image of each component. All components go through one operator, that of their sum, so that they add up
// to the image whatever their light. `use` says which error the result has.
Reconstructed regularize(const film::Film& film, bool by_components, const CancelCheck& cancel, SolveReport* report,
                         ErrorUse use = ErrorUse::Weights);
// Reconstructs a film by its features, which the caller has already filtered (feature_filter.h).
Reconstructed regularize(const film::Film& film, const film::Features& features, bool by_components,
                         const CancelCheck& cancel, SolveReport* report, ErrorUse use = ErrorUse::Weights);

}  // namespace gradus::reconstruct
