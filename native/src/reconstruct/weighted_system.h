// The matrix A = W_d + Dᵀ W_g D of a weighted screened Poisson problem on a grid with a free border, and its coarser versions.
#pragma once

#include "reconstruct/field.h"

namespace gradus {

struct WeightedSystem {
  WeightedSystem() = default;
  WeightedSystem(int width, int height);
  int width() const { return data.width(); }
  int height() const { return data.height(); }
  // Fills diagonal and smoothing from the weights.
  void finish();

  Field data;       // weight of x(p) = I(p)
  Field right, up;  // weights of the differences towards x + 1 and y + 1; 0 in the last column and row
  Field diagonal;   // of A
  Field smoothing;  // damping / diagonal
};

// On cells of 2×2: data weights add up; difference weights are conductances, in series along the difference and in parallel across it, so
// that a weak difference between strong ones stays weak. `coarse` has half the size, rounded up.
void coarsen(const WeightedSystem& fine, WeightedSystem* coarse);

// out = A x for one row of one channel.
void apply_row(const WeightedSystem& a, const Field& x, int y, int channel, float* out);

}  // namespace gradus
