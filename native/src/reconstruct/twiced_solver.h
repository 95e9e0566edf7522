// A minimum decides about differences, the noisy image about means (twicing). Consistent, not unbiased.
#pragma once

#include "reconstruct/twicing.h"
#include "reconstruct/weighted_least_squares.h"

namespace gradus::reconstruct {

class TwicedSolver final : public LinearOperator {
 public:
  // All weights come from the first three channels of `images`, which share them, and are frozen.
  TwicedSolver(const film::GradientImages& images, Minimum minimum, float alpha)
      : minimum_(std::move(minimum)), twicing_(images, minimum_.solution, alpha), alpha_(alpha) {}

  void apply(const PoissonPlanes& planes, float* out) const override;
  int solved_channels() const { return minimum_.solution.channels(); }
  // What apply() gives for one of these channels of the images that the weights come from, at hardly a cost.
  void read_solution(const PoissonPlanes& planes, int channel, float* out) const;

 private:
  Minimum minimum_;
  Twicing twicing_;
  float alpha_;  // of the start and of the twicing
};

}  // namespace gradus::reconstruct
