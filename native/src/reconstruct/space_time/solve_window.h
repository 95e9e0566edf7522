// Conjugate gradients over a window, all channels side by side, each with its own step sizes.
#pragma once

#include "reconstruct/conjugate_gradient.h"
#include "reconstruct/space_time/time_ladder.h"

namespace gradus::reconstruct {

// Work space, kept from solve to solve: with x, all that a solve holds per channel, 16 bytes per pixel and frame.
struct WindowFields {
  explicit WindowFields(const Frames& like) : r(like), p(like), z(like) {}
  Frames r, p, z;
};

// Improves x until the goal is reached or `max_steps` are done. fields->r: the right side, which is overwritten.
CgReport solve_window(const SpaceTimeSystem& system, TimeLadder* preconditioner, const CgGoal& goal, int max_steps,
                      const CancelCheck& cancel, WindowFields* fields, Frames* x);

}  // namespace gradus::reconstruct
