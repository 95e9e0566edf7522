// A snapshot of the scene one frame earlier or later, made from the motion data of the current frame.
#pragma once

#include <memory>

#include "base/cancel_check.h"
#include "scene/snapshot.h"

namespace gradus::scene {

// Returns the snapshot at the Previous or Next frame. Objects, shapes and the camera are static at their positions of
// that frame; materials and lights are those of the current frame. Unchanged data are shared. `share` is the fraction
// of the motion, 0 to 1: vertices move linearly, objects and the camera as while the shutter is open. Throws Error
// CANCELLED or OUT_OF_MEMORY.
std::shared_ptr<const Snapshot> moved_snapshot(
    const Snapshot& snapshot, Moment when, const CancelCheck& is_cancelled = [] { return false; }, float share = 1.0f);

}  // namespace gradus::scene
