// Space-time screened Poisson reconstruction of a window (Manzi et al. 2016, "Temporal gradient-domain path tracing",
// eq. 3): pixels, their differences in space, along the links from frame to frame, and mixed ones. The system lies in
// system.h, its solver in time_ladder.h.
#pragma once

#include <memory>

#include "reconstruct/solver.h"
#include "reconstruct/space_time/solve_window.h"
#include "reconstruct/space_time/window_twicing.h"

namespace gradus::reconstruct {

// A frozen linear operator W: weights and links come from one source, and every other plane of these frames goes
// through the same ones (contract 3.4). L2: minimises α²‖x−I‖² + Σ‖Hx−g‖² over all kinds of differences; unbiased. L1:
// as of single frames, with rows of all kinds; consistent. Solutions are exact to a residual of 1e-5 of the right side.
class WindowSolver {
 public:
  // reconstruction: L2 or L1, whose weights come from the first three channels of `source`. alpha 0: what measures best
  // (chosen_alpha()).
  WindowSolver(const WindowSource& source, uint32_t reconstruction, float alpha, const CancelCheck& cancel,
               SolveReport* report);

  // The channels that the constructor has solved for, the first three at most, by frames.
  const Frames& solution() const { return solution_; }
  Frames take_solution() { return std::move(solution_); }

  // x = W(planes) for some channels, three at most, of a source with the same frames.
  Frames apply(const WindowSource& planes, int first_channel, int channels, const CancelCheck& cancel,
               SolveReport* report) const;

 private:
  Frames solve(const WindowSource& planes, int first_channel, int channels, const CgGoal& goal, int max_steps,
               const CancelCheck& cancel, SolveReport* report) const;
  Frames minimise_l1(const WindowSource& source, float alpha, const CancelCheck& cancel, SolveReport* report);

  SpaceTimeSystem system_;
  std::unique_ptr<const WindowTwicing> twicing_;  // of L1
  Frames solution_;
};

}  // namespace gradus::reconstruct
