// Which components are small everywhere, as a few samples tell that are thrown away.
//
// As in the other pilot (render/pilot.h) the answer hangs on scene and settings alone: not on samples that are kept, on
// how many will be taken, on threads or on the region, or frames that are merged would hold different components
// (contract 2.1).
#pragma once

#include <atomic>
#include <cstdint>

#include "integrator/integrator.h"
#include "lpe/components.h"
#include "render/plan.h"

namespace gradus::render {

struct SmallComponents {
  uint32_t bits = 0;     // of the set
  uint64_t samples = 0;  // that were taken, and thrown away
};

// Runs in the caller's arena. `integrator`: without offsets, made for pilot_settings() and the set.
SmallComponents find_small_components(const integrator::Integrator& integrator, const GradusSettings& settings,
                                      const lpe::ComponentSet& set, int channels, const std::atomic<bool>& stop);

// Says which belong to Residual, and why.
void explain(const SmallComponents& small, const lpe::ComponentSet& set, Reasons* skipped);

}  // namespace gradus::render
