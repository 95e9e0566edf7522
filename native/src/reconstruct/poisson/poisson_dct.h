// Applies (α² + DᵀD)⁻¹ by cosine transforms. This is exact for constant weights and a free border (Bhat et al. 2008,
// "Fourier analysis of the 2D screened Poisson equation for gradient domain problems").
#pragma once

#include <functional>
#include <vector>

#include "reconstruct/poisson/dct.h"

namespace gradus::reconstruct {

class PoissonDct {
 public:
  PoissonDct(int width, int height);
  int width() const { return row_.length(); }
  int height() const { return column_.length(); }

  // Writes row y of the right side, one channel after another. Called from several threads, once for each row.
  using FillRow = std::function<void(int y, float* row)>;
  // Receives row y of the solution, one channel after another. Called from several threads, once for each row.
  using TakeRow = std::function<void(int y, const float* row)>;
  // Returns Σb of a channel, where the caller knows it more exactly than by sums of floats. Called after all rows are
  // filled; may be empty.
  using Sum = std::function<double(int channel)>;
  // Solves (data_weight + DᵀD) x = b. `work` holds width·height·channels floats. The result is deterministic for any
  // number of threads, and a channel's bits do not depend on the other channels.
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
