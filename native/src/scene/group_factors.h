// Measures what light samples of suns, the world and other emitters are worth where the camera looks.
#pragma once

#include <memory>

#include "base/commit_monitor.h"
#include "light/light_table.h"

namespace gradus::scene {

class Snapshot;

// Returns the factors with which light samples and BSDF samples together have the minimum variance times time, measured
// at some points that the camera sees and at some that these see. It reads geometry, materials, camera and light table.
// All factors are 1 without a camera, or if there is nothing to choose: one group of emitters that is not a uniform
// world. A uniform world is left out in any case if kinds of bounces may meet different surfaces, since light samples
// of it and BSDF samples of it would show different light. Throws Error CANCELLED.
light::GroupFactors measure_group_factors(const Snapshot& snapshot, const CommitMonitor& monitor);

// Returns the scene as light samples see it with the factors of `other`, an earlier moment of it: replayed samples then
// choose the emitters that they chose there. Measured factors may change from frame to frame, and any factors give the
// same light. Returns the scene itself if its factors are the same, or if one of both leaves out the world.
std::shared_ptr<const Snapshot> with_factors_of(const Snapshot& other, std::shared_ptr<const Snapshot> scene);

}  // namespace gradus::scene
