// Finds components that are small in the whole image, by a few samples that are discarded.
//
// As in the pilot for gradients (render/pilot.h), the result depends only on scene and settings: not on samples that
// are kept, on their number, on threads or on the region. Otherwise films that are merged would hold different
// components.
#pragma once

#include <atomic>
#include <cstdint>

#include "integrator/integrator.h"
#include "lpe/components.h"
#include "render/plan.h"

namespace gradus::render {

struct SmallComponents {
  uint32_t bits = 0;         // bits of the small components of the set
  uint64_t samples = 0;      // number of samples taken, which are discarded
  double cpu_seconds = 0.0;  // CPU time of the threads that took them
};

// Takes the samples in the caller's task arena. `integrator` has no offset paths and was made for pilot_settings() and
// `set`.
SmallComponents find_small_components(const integrator::Integrator& integrator, const GradusSettings& settings,
                                      const lpe::ComponentSet& set, int channels, const std::atomic<bool>& stop);

// Adds the merged components and the reason to `skipped`.
void explain(const SmallComponents& small, const lpe::ComponentSet& set, Reasons* skipped);

}  // namespace gradus::render
