// Measures what light samples of suns, the world and other emitters are worth where the camera looks.
#pragma once

#include "base/commit_monitor.h"
#include "light/light_table.h"

namespace gradus::scene {

class Snapshot;

// Returns the factors with which the light samples of a scene have the least variance times time, where BSDF sampling
// finds the same light. They are found at some points that the camera sees, and at some that these see. The snapshot is
// complete except for the factors of its light table. Without a camera, or with one group of emitters with a map or
// bounds, all factors are 1. Throws Error CANCELLED.
light::GroupFactors measure_group_factors(const Snapshot& snapshot, const CommitMonitor& monitor);

}  // namespace gradus::scene
