// Pixels that need no reconstruction: background, and whatever else has no noise.
#pragma once

#include <cstdint>
#include <vector>

#include "film/film.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// 1 where neither a pixel nor its differences, nor those of the eight pixels around it, show any deviation between the
// two halves: they are known. `images` have deviations; what is missing or unknown is not settled, nor is what is
// black: light may be too rare to have been found there. Without any surface (alpha 0) black is black.
std::vector<uint8_t> find_noise_free(const film::GradientImages& images);

// The smallest rectangle with all pixels that are not settled, and one pixel around them as far as there is one; empty
// where all are. No difference that is in doubt crosses its border.
Region noisy_region(const std::vector<uint8_t>& noise_free, int width, int height);

// Reconstructs by L1, but settled pixels keep their values, and only the region around the others is solved for. L1's
// weights hold settled pixels only nearly, and its twicing would give them a share of their neighbours' noise. `images`
// have deviations.
std::vector<float> reconstruct_noisy_region(const film::GradientImages& images, uint32_t reconstruction, float alpha,
                                            const CancelCheck& cancel, SolveReport* report);

}  // namespace gradus::reconstruct
