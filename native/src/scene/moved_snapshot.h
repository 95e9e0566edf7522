// The scene one frame earlier or later, as far as vectors know it.
#pragma once

#include <memory>

#include "base/cancel_check.h"
#include "scene/snapshot.h"

namespace gradus::scene {

// when: Previous or Next. Objects, shapes and the camera are where they are then, at rest; materials and lights are
// those of the frame. What does not move is shared. share: of the way there; vertices go straight, objects and the
// camera as while the shutter is open. Throws Error CANCELLED or OUT_OF_MEMORY.
std::shared_ptr<const Snapshot> moved_snapshot(
    const Snapshot& snapshot, Moment when, const CancelCheck& is_cancelled = [] { return false; }, float share = 1.0f);

}  // namespace gradus::scene
