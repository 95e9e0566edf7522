// Path guiding: learns where the light of a scene comes from, by paths that are discarded (Müller, Gross and Novák,
// "Practical path guiding for efficient light-transport simulation", 2017).
#pragma once

#include "guide/guiding_field.h"
#include "integrator/integrator.h"

namespace gradus::integrator {

struct GuideTraining {
  // Whether paths should be guided, and by what. The field is null if it would guide almost nowhere, and that of the
  // first half of the paths where it does not pay.
  bool pays = false;
  std::shared_ptr<const guide::GuidingField> field;
  uint64_t paths = 0;         // number of paths, which are discarded
  double guided_share = 0.0;  // of the samples of rough surfaces, in cells where the field guides
  // Variance and estimated time of a path that the field of the first half guides, over those without a guide. They are
  // known if there is a field.
  double noise_ratio = 1.0, time_ratio = 1.0;
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
