// Weights of rows by the noise that was measured of them.
#pragma once

#include <vector>

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Deviation of differences over that of pixels where nobody knows their noise: as of the L2 solver.
inline constexpr float kUnknownAlpha = 0.4f;

// Weights scale²/(s² + floor²) of a kind of rows. s: the mean over the 3×3 rows around each of the deviations that the
// two halves show, the row's own with 1/3 of all weight. Neighbours lend theirs, but an outlier, as which a firefly
// stands in its pixel and all differences beside it, lends no more than is usual around it.
class NoiseWeights {
 public:
  // Deviations by pixel, not finite where they are unknown.
  NoiseWeights(const std::vector<float>& deviations, int width, int height);
  // unknown: s of rows around which no deviation is known, in units of the scale.
  void read_row(int y, float scale, float unknown, float* weights) const;

 private:
  float typical_level(int x, int y) const;

  Field own_, lent_, known_;
};

// Single precision tells a pixel's weight from its differences' down to a ratio of some 1e-6. Where differences were
// known far better than pixels, as under fireflies, the matrix would be singular and conjugate gradients diverge. So a
// difference is taken to be uncertain by this share of its pixel's noise, which loses nothing: it takes the mean of a
// million pixels to bring theirs down to it.
inline constexpr float kMinShare = 1e-3f;
inline float limited_difference(float weight, float of_pixel) {
  return of_pixel > 0.0f ? weight / (1.0f + kMinShare * kMinShare * weight / of_pixel) : weight;
}

}  // namespace gradus::reconstruct
