// (α² + DᵀD)⁻¹ by cosine transforms: exact, for constant weights and a free border (Bhat et al. 2008, "Fourier analysis
// of the 2D screened Poisson equation for gradient domain problems").
#pragma once

#include <functional>
#include <vector>

#include "reconstruct/dct.h"

namespace gradus::reconstruct {

class PoissonDct {
 public:
  PoissonDct(int width, int height);
  int width() const { return row_.length(); }
  int height() const { return column_.length(); }

  // Writes row y of the right side, one channel after another; called from several threads, each row once.
  using FillRow = std::function<void(int y, float* row)>;
  // Takes row y of the solution; likewise.
  using TakeRow = std::function<void(int y, const float* row)>;
  // Σb of a channel, asked for after all rows are filled, where it is known better than by sums of floats; may be
  // empty.
  using Sum = std::function<double(int channel)>;
  // Solves (data_weight + DᵀD) x = b. work: width·height·channels floats. Deterministic for any number of threads; a
  // channel's bits do not depend on the others.
  void solve(float data_weight, int channels, const FillRow& fill, const Sum& sum, const TakeRow& take,
             float* work) const;

 private:
  void rows_forward(int channels, const FillRow& fill, float* work) const;
  void columns(float data_weight, int channels, const double* sums, float* work) const;
  void rows_inverse(int channels, const TakeRow& take, float* work) const;

  Dct row_, column_;
  std::vector<float> eigenvalue_x_, eigenvalue_y_;  // of DᵀD
};

}  // namespace gradus::reconstruct
