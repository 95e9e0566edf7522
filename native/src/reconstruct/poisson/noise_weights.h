// Weights of the rows of a least squares system by their measured noise. A row is a pixel or a difference.
#pragma once

#include <vector>

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Deviation of a difference over that of a pixel, for unknown noise; the same value as α of the L2 solver.
inline constexpr float kUnknownAlpha = 0.4f;

// Weights scale²/(s² + floor²) for all rows of one kind. s is the mean of the measured deviations over the 3×3 rows
// around each; the row's own deviation has about 1/3 of the total weight. A firefly is an outlier in its pixel and in
// all differences of that pixel, so the contribution of an outlier to its neighbours' mean is limited to the level that
// is usual around it.
class NoiseWeights {
 public:
  // `deviations` has one value for each pixel; values that are not finite are unknown.
  NoiseWeights(const std::vector<float>& deviations, int width, int height);
  // Writes the weights of row y. `unknown` is s, in units of `scale`, where no deviation is known nearby.
  void read_row(int y, float scale, float unknown, float* weights) const;

 private:
  float typical_level(int x, int y) const;

  Field own_, lent_, known_;
};

// Single precision cannot represent a pixel's weight beside its differences' weights below a ratio of about 1e-6. Where
// differences are known far better than pixels, as under fireflies, the matrix becomes singular and conjugate gradients
// diverge. Differences therefore get a minimum uncertainty, this share of their pixel's noise. This loses nothing: the
// mean of a million pixels has that much noise.
inline constexpr float kMinShare = 1e-3f;
inline float limited_difference(float weight, float of_pixel) {
  return of_pixel > 0.0f ? weight / (1.0f + kMinShare * kMinShare * weight / of_pixel) : weight;
}

}  // namespace gradus::reconstruct
