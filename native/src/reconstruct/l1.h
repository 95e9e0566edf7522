// L1: the minimiser decides about differences, the noisy image about means (twicing). Consistent, not unbiased.
#pragma once

#include "reconstruct/l1_minimiser.h"
#include "reconstruct/twicing.h"

namespace gradus {

class L1Solver final : public LinearOperator {
 public:
  // Estimates all weights from the first three channels of `images`, which share them, and freezes them.
  L1Solver(const GradientImages& images, float alpha, const CancelTest& cancel, SolveReport* report)
      : minimiser_(images, alpha, cancel, report), twicing_(images, minimiser_.solution(), alpha) {}

  void apply(const PoissonPlanes& planes, float* out) const override;
  int solved_channels() const { return minimiser_.solution().channels(); }
  // What apply() gives for one of these channels of the images that the weights come from, at hardly a cost.
  void read_solution(const PoissonPlanes& planes, int channel, float* out) const;

 private:
  L1Minimiser minimiser_;
  Twicing twicing_;
};

}  // namespace gradus
