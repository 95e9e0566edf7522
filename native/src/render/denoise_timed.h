// Runs the denoiser for a still image or a frame of an animation, and records it in the statistics.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "output/denoise_combined.h"
#include "render/stats.h"

namespace gradus::render {

// Calls denoise_combined() with the film's own reconstruction. Adds the time, the name of the denoiser or a warning
// about its failure to `stats`. Returns RGBA of the region, or an empty vector on failure.
std::vector<float> denoise_timed(const output::OidnLibrary& library, const film::Film& film, const Region& region,
                                 uint32_t threads, const CancelCheck& cancel, const std::vector<float>& combined,
                                 RenderStats* stats);

}  // namespace gradus::render
