// Chooses whether a render guides its paths, and how many paths it discards to learn from
// (integrator/guide_training.h).
#pragma once

#include <string>

#include "integrator/guide_training.h"
#include "render/plan.h"

namespace gradus::render {

// Returns the number of paths to learn from, for a render of `samples` samples per pixel of a region. If it does not
// guide paths, returns 0 and sets `why_not`; it does not if `why_not` has a reason already.
uint32_t guide_paths(const GradusSettings& settings, uint32_t samples, const Region& region, std::string* why_not);

// Adds what the training has found to `chosen` or `skipped`.
void explain(const integrator::GuideTraining& training, Reasons* chosen, Reasons* skipped);

}  // namespace gradus::render
