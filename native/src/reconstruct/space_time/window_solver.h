// Space-time screened Poisson reconstruction of a window (Manzi et al. 2016, "Temporal gradient-domain path tracing",
// eq. 3), from pixels, their differences in space, their differences along correspondences from frame to frame, and
// mixed ones. The system is in system.h, its preconditioner in time_ladder.h.
#pragma once

#include <memory>

#include "base/cancel_check.h"
#include "reconstruct/solve_report.h"
#include "reconstruct/space_time/solve_window.h"
#include "reconstruct/space_time/window_twicing.h"

namespace gradus::reconstruct {

// A frozen linear operator W: weights and correspondences come from one source, and all other planes of these frames go
// through the same ones. L2 minimises α²‖x−I‖² + Σ‖Hx−g‖² over all kinds of differences and is unbiased. L1 works as
// for single frames, with rows of all kinds, and is consistent. Solutions are exact to a residual of 1e-5 of the right
// side.
class WindowSolver {
 public:
  // `reconstruction` is L2 or L1; the weights come from the first three channels of `source`. `alpha` 0 selects the
  // default (chosen_alpha()).
  WindowSolver(const WindowSource& source, uint32_t reconstruction, float alpha, const CancelCheck& cancel,
               SolveReport* report);

  // Returns the solution of the constructor, at most the first three channels, for each frame.
  const Frames& solution() const { return solution_; }
  Frames take_solution() { return std::move(solution_); }

  // Returns x = W(planes) for at most three channels of a source with the same frames.
  Frames apply(const WindowSource& planes, int first_channel, int channels, const CancelCheck& cancel,
               SolveReport* report) const;

 private:
  Frames solve(const WindowSource& planes, int first_channel, int channels, const CgGoal& goal, int max_steps,
               const CancelCheck& cancel, SolveReport* report) const;
  Frames minimise_l1(const WindowSource& source, float alpha, const CancelCheck& cancel, SolveReport* report);

  SpaceTimeSystem system_;
  std::unique_ptr<const WindowTwicing> twicing_;  // only for L1
  Frames solution_;
};

}  // namespace gradus::reconstruct
