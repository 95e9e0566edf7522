// The regression as the data of a least squares problem whose differences are those sampled and the regression's own,
// by their errors.
#pragma once

#include "reconstruct/weighted_least_squares.h"

namespace gradus::reconstruct {

class FusedDifferences {
 public:
  // images: of the frame, with deviations; scale: 1 of the regression, in their units; unknown: the deviation of
  // differences of which nothing is known. Estimates all weights from `regressed`, whose squared error is `error`, and
  // freezes them. Alpha goes through those of the colours.
  FusedDifferences(const film::GradientImages& images, float scale, float unknown, const Field& regressed,
                   const Field& error, const CancelCheck& cancel, SolveReport* report);

  Field take_solution() { return std::move(solution_); }
  // Of other planes by the same weights.
  Field apply(const film::GradientImages& images, const Field& regressed, const CancelCheck& cancel,
              SolveReport* report);

 private:
  SolverPlanes blend(const film::GradientImages& images, const Field& regressed) const;

  float scale_;
  Field share_x_, share_y_;  // of a difference that the regression's has
  WeightedLeastSquares system_;
  Field solution_;
};

}  // namespace gradus::reconstruct
