// Reconstruction whose differences come from a minimum and whose local means come from the noisy image (twicing.h). It
// is consistent, not unbiased.
#pragma once

#include "reconstruct/twicing.h"
#include "reconstruct/weighted_least_squares.h"

namespace gradus::reconstruct {

class TwicedSolver final : public LinearOperator {
 public:
  // Freezes the weights of `minimum` and those of the twicing, which come from the first three channels of `images`.
  TwicedSolver(const film::GradientImages& images, Minimum minimum, float alpha)
      : minimum_(std::move(minimum)), twicing_(images, minimum_.solution, alpha), alpha_(alpha) {}

  void apply(const PoissonPlanes& planes, float* out) const override;
  int solved_channels() const { return minimum_.solution.channels(); }
  // Writes what apply() gives for one of the solved channels of the images that the weights come from, almost without
  // cost.
  void read_solution(const PoissonPlanes& planes, int channel, float* out) const;

 private:
  Minimum minimum_;
  Twicing twicing_;
  float alpha_;  // weight α of the L2 solution that starts an iteration
};

}  // namespace gradus::reconstruct
