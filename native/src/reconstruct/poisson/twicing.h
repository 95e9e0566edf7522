// Twicing (Tukey 1977): x = x₀ + S W (I − x₀) restores to an estimate x₀ what it lost of the noisy image I, smoothed by
// the L2 solver S = α²(α² + DᵀD)⁻¹. This equals integrating the differences of x₀ with I by L2: the estimate decides
// about differences, the noisy image about local means. W limits outliers of the residual.
#pragma once

#include "reconstruct/field.h"
#include "reconstruct/poisson/poisson_dct.h"
#include "reconstruct/poisson/solver.h"

namespace gradus::reconstruct {

class Twicing {
 public:
  // Estimates W from the first channels of `images`, as many as `estimate` (x₀) has, and freezes it.
  Twicing(const film::GradientImages& images, const Field& estimate, float alpha);

  // Replaces x₀ by x for one channel of `planes`. `values` has the stride of `planes`.
  void apply(const PoissonPlanes& planes, float* values) const;

 private:
  Field weights_;  // W; 0 where I is not finite
  PoissonDct dct_;
  float data_weight_;
};

// Returns the square of the bound τ on residuals from their squares: Σ min(e²/τ², 1) = ln n (Wang, Zheng, Zhou, Zhou
// 2021, "A new principle for tuning-free Huber regression"). For noise of deviation σ it is σ√(n/ln n): the mean of n
// such values then loses less than its own deviation, while up to ln n values of any size hardly change it. Reorders
// `squares`. Returns infinity if n < 2.
float outlier_bound_squared(std::vector<float>* squares);

// Replaces the squared residuals in the block [x0, x1) × [y0, y1) of a field by the shares of the residuals that lie
// within the block's bound (W above). Values that are not finite become 0.
void limit_block(int x0, int x1, int y0, int y1, Field* field);
// Calls limit_block() for every block of about 32×32 pixels.
void limit_blocks(Field* field);

}  // namespace gradus::reconstruct
