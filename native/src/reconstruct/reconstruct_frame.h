// What a frame becomes: its picture, and what is known of the picture's error.
#pragma once

#include "reconstruct/reconstructed.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solver.h"

namespace gradus {

// All components, each by its own solver, added up (contract 3.4). reconstruction: never AUTO. Throws invalid_operation for a frame without
// what it reads.
// components: if given, the picture of each.
Reconstructed reconstruct_frame(const Frame& frame, uint32_t reconstruction, float alpha, bool wants_error, const CancelTest& cancel,
                                SolveReport* report, std::vector<std::vector<float>>* components = nullptr);

// Of several components each keeps what is not negative, where pictures are clamped (contract 5.5), so that they add up as delivered.
void clamp_component(const Frame& frame, uint32_t reconstruction, size_t components, std::vector<float>* image);

// One component; with its error only where the reconstruction estimates it itself (REGULARIZED), else see error_estimate.h.
// guides: of the frame; looked at by REGULARIZED alone.
Reconstructed reconstruct_component(const Frame& frame, int component, uint32_t reconstruction, float alpha, bool wants_error,
                                    ComponentGuides* guides, const CancelTest& cancel, SolveReport* report);

// *sum += term, image by image; an empty sum is 0.
void add_image(std::vector<float> term, std::vector<float>* sum);

}  // namespace gradus
