// The step of the denoiser, of a render and of a frame of a sequence.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "output/denoise_combined.h"
#include "render/stats.h"

namespace gradus::render {

// denoise_combined() by the frame's own reconstruction; the stats tell what it took, by whom, or what went wrong. Empty
// then.
std::vector<float> denoise_timed(const output::OidnLibrary& library, const film::Film& film, const Region& region,
                                 uint32_t threads, const CancelCheck& cancel, const std::vector<float>& combined,
                                 RenderStats* stats);

}  // namespace gradus::render
