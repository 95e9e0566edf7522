// L1 by iteratively reweighted least squares: minimises Σ α‖x−I‖ + ‖Dx−g‖ with the norm of a pixel's RGB (thesis eq. 5.13 with k = 1).
// Consistent, not unbiased; darkens slightly at few samples.
#pragma once

#include <memory>

#include "reconstruct/multigrid.h"
#include "reconstruct/solver.h"

namespace gradus {

class L1Solver final : public LinearOperator {
 public:
  // Estimates the weights from the first three channels of `images`, which share them, and freezes them.
  L1Solver(const GradientImages& images, float alpha, const CancelTest& cancel, SolveReport* report);

  void apply(const PoissonPlanes& planes, float* out) const override;
  // The solution for the channels that the weights come from, at no further cost; `stride` floats from pixel to pixel.
  void read_solution(float* out, size_t stride) const;
  int solved_channels() const { return solution_.channels(); }

 private:
  Multigrid multigrid_;  // holds the weights
  Field solution_;
  float alpha_;
};

}  // namespace gradus
