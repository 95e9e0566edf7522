// A picture before there are samples to make one of: at a quarter of the width and height, by the features of the
// surfaces, enlarged. Its samples are its own and thrown away, an eighth of one per pixel.
#pragma once

#include <atomic>
#include <vector>

#include "integrator/integrator.h"
#include "render/plan.h"

namespace gradus::render {

// The settings that its integrator is made for, which takes plain paths.
GradusSettings quarter_settings(GradusSettings settings);

struct QuarterPreview {
  std::vector<float> rgba;         // of the region; empty if it was stopped
  std::vector<float> error;        // where pass Error is asked for: of what this size can show
  double seconds_per_pixel = 0.0;  // of its reconstruction
};

// Of the region that is delivered. Runs in the caller's arena. settings and plan: the render's.
QuarterPreview render_quarter_preview(const integrator::Integrator& integrator, const GradusSettings& settings,
                                      const Plan& plan, const std::atomic<bool>& stop);

}  // namespace gradus::render
