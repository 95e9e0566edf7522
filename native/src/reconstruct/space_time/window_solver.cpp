#include "reconstruct/space_time/window_solver.h"

#include <algorithm>

#include "base/error.h"
#include "reconstruct/chosen_alpha.h"
#include "reconstruct/poisson/weighted_least_squares.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/space_time/value_rows.h"
#include "reconstruct/space_time/weigh_by_residuals.h"
#include "reconstruct/space_time/weigh_uniformly.h"

namespace gradus::reconstruct {
namespace {

constexpr CgGoal kExact{.residual = 1e-5f};
constexpr int kMaxSteps = 100;

// As minimise_l1.cpp has them, but for how far a system is solved: what is left here has less than 1e-4 of the error's
// square (docs/method.md, "Space-time reconstruction").
constexpr float kFirstFloor = 0.05f;
constexpr float kLastFloor = 2e-3f;
constexpr float kFloorFactor = 0.2f;
constexpr CgGoal kOuterGoal{.residual = 1e-2f};
constexpr int kMaxInnerSteps = 1;
constexpr CgGoal kFinalGoal{.residual = 3e-4f};

// The median of the frames' scales.
float window_scale(const WindowSource& source) {
  const WindowSize size = source.size();
  const int channels = std::min(size.channels, 3);
  std::vector<float> scales;
  Field primal(size.width, size.height, channels);
  for (int t = 0; t < size.frames; ++t) {
    for_pieces(size.height, [&](int begin, int end) {
      ValueRow row(size, 0, channels);
      for (int y = begin; y < end; ++y) {
        row.load(source, RowKind::kPrimal, t, y);
        for (int c = 0; c < channels; ++c) std::copy_n(row.channel(c), size.width, primal.row(y, c));
      }
    });
    scales.push_back(robust_scale(primal));
  }
  return median_or_one(&scales);
}

}  // namespace

WindowSolver::WindowSolver(const WindowSource& source, uint32_t reconstruction, float alpha, const CancelCheck& cancel,
                           SolveReport* report)
    : system_(source) {
  alpha = chosen_alpha(reconstruction, alpha);
  const int channels = std::min(source.size().channels, 3);
  switch (reconstruction) {
    case GRADUS_RECONSTRUCTION_L2:
      weigh_uniformly(source, alpha, &system_);
      solution_ = solve(source, 0, channels, kExact, kMaxSteps, cancel, report);
      return;
    case GRADUS_RECONSTRUCTION_L1:
      solution_ = minimise_l1(source, alpha, cancel, report);
      break;
    default:
      throw unsupported("no solver of windows for reconstruction " + std::to_string(reconstruction));
  }
  if (cancel()) return;
  twicing_ = std::make_unique<WindowTwicing>(source, solution_, system_, alpha);
  twicing_->apply(source, 0, system_, &solution_);
}

Frames WindowSolver::apply(const WindowSource& planes, int first_channel, int channels, const CancelCheck& cancel,
                           SolveReport* report) const {
  Frames x = solve(planes, first_channel, channels, kExact, kMaxSteps, cancel, report);
  if (twicing_) twicing_->apply(planes, first_channel, system_, &x);
  return x;
}

Frames WindowSolver::solve(const WindowSource& planes, int first_channel, int channels, const CgGoal& goal,
                           int max_steps, const CancelCheck& cancel, SolveReport* report) const {
  TimeLadder ladder(system_, channels);
  ladder.update();
  Frames x = system_.make_fields(channels);
  WindowFields fields(x);
  system_.right_side(planes, first_channel, &fields.r);
  add_solve(solve_window(system_, &ladder, goal, max_steps, cancel, &fields, &x), report);
  return x;
}

// Iteratively reweighted least squares from L2 on; the first system needs no more digits than the others before the
// last.
Frames WindowSolver::minimise_l1(const WindowSource& source, float alpha, const CancelCheck& cancel,
                                 SolveReport* report) {
  const int channels = std::min(source.size().channels, 3);
  const float scale = window_scale(source);
  TimeLadder ladder(system_, channels);
  Frames x = system_.make_fields(channels);
  WindowFields fields(x);
  const auto improve = [&](const CgGoal& goal, int max_steps) {
    ladder.update();
    system_.right_side(source, 0, &fields.r);
    return solve_window(system_, &ladder, goal, max_steps, cancel, &fields, &x);
  };
  weigh_uniformly(source, alpha, &system_);
  report->inner_steps += improve(kOuterGoal, kMaxSteps).steps;
  float floor = kFirstFloor;
  for (bool last = false; !last && !cancel(); floor = std::max(floor * kFloorFactor, kLastFloor)) {
    ++report->outer_steps;
    last = floor <= kLastFloor;
    weigh_by_residuals(source, x, alpha, scale, floor, &system_);
    const CgReport inner = improve(last ? kFinalGoal : kOuterGoal, last ? kMaxSteps : kMaxInnerSteps);
    if (last) {
      add_solve(inner, report);
    } else {
      report->inner_steps += inner.steps;
    }
  }
  return x;
}

}  // namespace gradus::reconstruct
