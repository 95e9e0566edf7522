// Reconstruction of a whole film: its image and, on request, its estimated error and its components.
#pragma once

#include "base/cancel_check.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solve_report.h"

namespace gradus::reconstruct {

// Optional results of reconstruct_film().
struct ReconstructionOutputs {
  bool error = false, components = false;
};

// Reconstructs the sum of all components: each by its own solver, or all by one operator (REGULARIZED).
// `reconstruction` is never AUTO. Throws `invalid_operation` if the film lacks the gradients or features that the
// reconstruction reads.
Reconstructed reconstruct_film(const film::Film& film, uint32_t reconstruction, float alpha,
                               ReconstructionOutputs wanted, const CancelCheck& cancel, SolveReport* report);

// Reconstructs one component by any reconstruction except REGULARIZED. For its error see error_estimate.h.
std::vector<float> reconstruct_component(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                                         const CancelCheck& cancel, SolveReport* report);

// Returns whether a notable share of the samples is negative, because there are lights of negative strength.
bool has_negative_light(const film::Film& film);

// Returns whether a reconstruction of a film may deliver negative values: linear reconstructions may, and any if the
// film has negative light. Others are clamped at 0.
bool keeps_negative(const film::Film& film, uint32_t reconstruction);

// Changes component images so that no value is negative and that they add up to the clamped image. `images` have the
// film's channels; alpha is unchanged.
void clamp_components(int channels, std::vector<std::vector<float>>* images);

// Adds `term` to `sum`. An empty sum counts as 0.
void add_image(std::vector<float> term, std::vector<float>* sum);

}  // namespace gradus::reconstruct
