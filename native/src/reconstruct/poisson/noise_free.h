// Detection of pixels without noise, such as the background, which need no reconstruction.
#pragma once

#include <cstdint>
#include <vector>

#include "film/film.h"
#include "reconstruct/poisson/solver.h"

namespace gradus::reconstruct {

// Returns 1 for each pixel whose value, differences, and those of the eight pixels around it, show no deviation between
// the two half-buffers: these are known exactly. `images` must have deviations. Missing or unknown values do not count
// as noise-free. Black pixels do not either, because rare light may not have been found yet, unless no surface is
// visible (alpha 0).
std::vector<uint8_t> find_noise_free(const film::GradientImages& images);

// Returns the smallest rectangle that contains all noisy pixels and a margin of one pixel, as far as that lies in the
// image; an empty region if there are none. No noisy difference crosses its border.
Region noisy_region(const std::vector<uint8_t>& noise_free, int width, int height);

// Reconstructs by L1, but noise-free pixels keep their sampled values, and the system is only solved in the region
// around the others. L1's weights alone would let noise-free pixels move slightly, and its twicing would spread the
// noise of their neighbours to them. `images` must have deviations.
std::vector<float> reconstruct_noisy_region(const film::GradientImages& images, uint32_t reconstruction, float alpha,
                                            const CancelCheck& cancel, SolveReport* report);

}  // namespace gradus::reconstruct
