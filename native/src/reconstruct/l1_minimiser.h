// Minimises Σ α‖x−I‖ + ‖Dx−g‖ with the norm of a pixel's RGB (thesis eq. 5.13 with k = 1) by iteratively reweighted least squares.
#pragma once

#include "reconstruct/multigrid.h"
#include "reconstruct/solver.h"

namespace gradus {

class L1Minimiser {
 public:
  // Estimates the weights from the first three channels of `images`, which share them, and freezes them.
  L1Minimiser(const GradientImages& images, float alpha, const CancelTest& cancel, SolveReport* report);

  // The minimum for the channels that the weights come from.
  const Field& solution() const { return solution_; }
  // Another channel by the frozen weights: linear in `planes`.
  void apply(const PoissonPlanes& planes, float* out) const;

 private:
  Multigrid multigrid_;  // of the matrix, which holds the weights of the differences
  Field data_weights_;
  Field solution_;
  float alpha_;
};

}  // namespace gradus
