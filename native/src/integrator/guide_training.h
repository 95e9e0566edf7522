// Path guiding: learns where the light of a scene comes from, by paths that are discarded (Müller, Gross and Novák,
// "Practical path guiding for efficient light-transport simulation", 2017).
#pragma once

#include "guide/guiding_field.h"
#include "integrator/integrator.h"

namespace gradus::integrator {

struct GuideTraining {
  std::shared_ptr<const guide::GuidingField> field;  // null if guiding pays almost nowhere
  uint64_t paths = 0;                                // number of paths, which are discarded
  double guided_share = 0.0;                         // of the samples of rough surfaces, in cells where guiding pays
};

// Returns what about `paths` paths, spread over the frame, have learnt. Their random numbers do not depend on the seed
// and the frame of the settings, and the result does not depend on the number of threads. It is not complete on `stop`.
// Adds the CPU time to `cpu`, in nanoseconds.
GuideTraining train_guide(const IntegratorContext& context, uint32_t paths, const std::atomic<bool>& stop,
                          std::atomic<uint64_t>* cpu);
// Returns the snapshot with guided directions.
std::shared_ptr<const scene::Snapshot> guided_snapshot(const scene::Snapshot& snapshot,
                                                       std::shared_ptr<const guide::GuidingField> field);

}  // namespace gradus::integrator
