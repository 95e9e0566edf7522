// Develops the film of a still image or of a frame of an animation, and records the steps in the statistics.
#pragma once

#include <functional>

#include "output/developer.h"
#include "render/stats.h"

namespace gradus::render {

// Runs the steps of the developer on a film, its region and its options. Adds their times, their warnings and the name
// of the denoiser to `stats`. Calls `show` after each step that has changed the picture or its passes. Throws Error
// CANCELLED.
void develop(output::Developer* developer, const reconstruct::ReconstructionOutputs& wanted,
             const output::Developer::Source& source, const std::function<void()>& show,
             output::DevelopedFilm* developed, RenderStats* stats);

}  // namespace gradus::render
