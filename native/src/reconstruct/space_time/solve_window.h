// Conjugate gradients over a window. All channels are solved side by side, each with its own step sizes.
#pragma once

#include "reconstruct/poisson/conjugate_gradient.h"
#include "reconstruct/space_time/time_ladder.h"

namespace gradus::reconstruct {

// Work space, reused from solve to solve. Together with x, a solve holds 16 bytes per pixel, frame and channel.
struct WindowFields {
  explicit WindowFields(const Frames& like) : r(like), p(like), z(like) {}
  Frames r, p, z;
};

// Improves x until the goal is reached or `max_steps` are done. `fields->r` holds the right side and is overwritten.
CgReport solve_window(const SpaceTimeSystem& system, TimeLadder* preconditioner, const CgGoal& goal, int max_steps,
                      const CancelCheck& cancel, WindowFields* fields, Frames* x);

}  // namespace gradus::reconstruct
