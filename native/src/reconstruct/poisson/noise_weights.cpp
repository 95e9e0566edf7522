#include "reconstruct/poisson/noise_weights.h"

#include <algorithm>

#include "base/rows.h"
#include "base/types.h"

namespace gradus::reconstruct {
namespace {

// Noise below this value, in units of the image's scale, counts as none. Between 3e-3 and 3e-2 the error against the
// truth hardly changes (measured).
constexpr float kFloor = 1e-2f;
// Weight exp(−1/2σ²) of a direct neighbour in a Gaussian window of σ = 0.7 pixels.
constexpr float kBeside = 0.36f;
// Maximum contribution of a neighbour to the mean, in multiples of the level that is usual around it. Values of 3 to 8
// give the same error; without the limit the error is a tenth larger (measured).
constexpr float kMaxLent = 4.0f;

float beside(const Field& f, int x, int y) {
  const float *below = f.row(y - 1) + x, *here = f.row(y) + x, *above = f.row(y + 1) + x;
  return kBeside * (here[-1] + here[1] + below[0] + above[0] + kBeside * (below[-1] + below[1] + above[-1] + above[1]));
}

}  // namespace

NoiseWeights::NoiseWeights(const std::vector<float>& deviations, int width, int height)
    : own_(width, height, 1), lent_(width, height, 1), known_(width, height, 1) {
  for_rows(height, [&](int y) {
    const float* from = deviations.data() + size_t(y) * width;
    for (int x = 0; x < width; ++x) {
      known_.row(y)[x] = is_finite(from[x]) ? 1.0f : 0.0f;
      own_.row(y)[x] = is_finite(from[x]) ? from[x] : 0.0f;
    }
  });
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) lent_.row(y)[x] = std::min(own_.row(y)[x], kMaxLent * typical_level(x, y));
  });
}

void NoiseWeights::read_row(int y, float scale, float unknown, float* weights) const {
  for (int x = 0; x < own_.width(); ++x) {
    const float known = known_.row(y)[x] + beside(known_, x, y);
    const float s = known > 0.0f ? (own_.row(y)[x] + beside(lent_, x, y)) / known / scale : unknown;
    weights[x] = 1.0f / (s * s + kFloor * kFloor);
  }
}

// Considers the four lines through a row and its neighbours. Each line has the smaller of its two neighbours'
// deviations; returns the largest of these. The result is large within areas and along edges of noise and small around
// an outlier, even where differences have two outliers side by side.
float NoiseWeights::typical_level(int x, int y) const {
  const float *below = own_.row(y - 1) + x, *here = own_.row(y) + x, *above = own_.row(y + 1) + x;
  return std::max({std::min(here[-1], here[1]), std::min(below[0], above[0]), std::min(below[-1], above[1]),
                   std::min(below[1], above[-1])});
}

}  // namespace gradus::reconstruct
