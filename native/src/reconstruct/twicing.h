// Twicing (Tukey 1977): x = x₀ + S W (I − x₀) gives back to an estimate x₀ what it lost of the noisy image I, smoothed
// by the L2 solver S = α²(α² + DᵀD)⁻¹. The same as integrating the differences of x₀ with I by L2: the estimate decides
// about differences, the noisy image about means. W limits outliers of the residual.
#pragma once

#include "reconstruct/field.h"
#include "reconstruct/poisson_dct.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

class Twicing {
 public:
  // Estimates W from the first channels of `images`, as many as x₀ has, and freezes it.
  Twicing(const film::GradientImages& images, const Field& estimate, float alpha);

  // x₀ → x, one channel: `values` at the stride of `planes`.
  void apply(const PoissonPlanes& planes, float* values) const;

 private:
  Field weights_;  // W; 0 where I is not finite
  PoissonDct dct_;
  float data_weight_;
};

// Square of the bound τ on residuals, from their squares: Σ min(e²/τ², 1) = ln n (Wang, Zheng, Zhou, Zhou 2021, "A new
// principle for tuning-free Huber regression"). For noise of deviation σ it is σ√(n/ln n): what the mean of n such
// values loses by it stays below that mean's own deviation, while up to ln n values of any size hardly move it.
// Reorders `squares`; infinite where n < 2.
float outlier_bound_squared(std::vector<float>* squares);

// A field's squared residuals in the square [x0, x1) × [y0, y1) become the shares of the residuals that lie within its
// bound, W above; what is not finite, 0.
void limit_block(int x0, int x1, int y0, int y1, Field* field);
// The same in every square of about 32×32 pixels.
void limit_blocks(Field* field);

}  // namespace gradus::reconstruct
