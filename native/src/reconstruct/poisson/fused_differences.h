// Combination of the regression with sampled differences. The regression is the data of a least squares problem; each
// difference is the mean of the sampled one and the regression's own, weighted by their errors.
#pragma once

#include "reconstruct/poisson/weighted_least_squares.h"

namespace gradus::reconstruct {

class FusedDifferences {
 public:
  // Estimates all weights and freezes them. `images` belong to the film and have deviations. One unit of `regressed` is
  // `scale` units of `images`; `error` is its squared error. `unknown` is the deviation of differences without a
  // measured one. Alpha goes through the weights of the colours.
  FusedDifferences(const film::GradientImages& images, float scale, float unknown, const Field& regressed,
                   const Field& error, const CancelCheck& cancel, SolveReport* report);

  Field take_solution() { return std::move(solution_); }
  // Returns the solution for other planes by the frozen weights.
  Field apply(const film::GradientImages& images, const Field& regressed, const CancelCheck& cancel,
              SolveReport* report);

 private:
  SolverPlanes blend(const film::GradientImages& images, const Field& regressed) const;

  float scale_;
  Field share_x_, share_y_;  // share of the regression in each difference
  WeightedLeastSquares system_;
  Field solution_;
};

}  // namespace gradus::reconstruct
