// The first preview, before the film has enough samples: a quarter of the width and height, reconstructed with
// denoising features and enlarged. It takes its own samples, an eighth of one per full-size pixel, and discards them.
#pragma once

#include <atomic>
#include <vector>

#include "integrator/integrator.h"
#include "render/plan.h"

namespace gradus::render {

// Returns the settings for the integrator of the preview, which takes plain paths.
GradusSettings quarter_settings(GradusSettings settings);

struct QuarterPreview {
  std::vector<float> rgba;         // RGBA of the region; empty if `stop` became true
  std::vector<float> error;        // pass Error of the preview, if that pass is requested
  double seconds_per_pixel = 0.0;  // time of its reconstruction per small pixel
};

// Renders the preview of the delivered region in the caller's task arena. `settings` and `plan` are those of the full
// render.
QuarterPreview render_quarter_preview(const integrator::Integrator& integrator, const GradusSettings& settings,
                                      const Plan& plan, const std::atomic<bool>& stop);

}  // namespace gradus::render
