// What a frame becomes: its picture, and what is known of the picture's error.
#pragma once

#include "reconstruct/reconstructed.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// What is wanted besides the picture.
struct ReconstructionOutputs {
  bool error = false, components = false;
};

// The sum of all components (contract 3.4): each by its own solver, or all by one operator (REGULARIZED).
// reconstruction: never AUTO. Throws invalid_operation for a frame without what it reads.
Reconstructed reconstruct_film(const film::Film& film, uint32_t reconstruction, float alpha,
                               ReconstructionOutputs wanted, const CancelCheck& cancel, SolveReport* report);

// One component, by all reconstructions but REGULARIZED; without an error: see error_estimate.h.
std::vector<float> reconstruct_component(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                                         const CancelCheck& cancel, SolveReport* report);

// Of light that lights below 0 take away (contract 5.5): linear reconstructions keep it, others cut it off.
bool keeps_negative(uint32_t reconstruction);

// Where pictures are clamped components become such that none is negative and that they add up to the picture as
// clamped. images: of the frame's channels; alpha stays what it is.
void clamp_components(uint32_t reconstruction, int channels, std::vector<std::vector<float>>* images);

// *sum += term, image by image; an empty sum is 0.
void add_image(std::vector<float> term, std::vector<float>* sum);

}  // namespace gradus::reconstruct
