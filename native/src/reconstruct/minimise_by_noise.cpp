#include "reconstruct/minimise_by_noise.h"

#include <algorithm>
#include <cmath>

#include "base/types.h"
#include "reconstruct/field_values.h"
#include "reconstruct/rows.h"

namespace gradus {
namespace {

// Noise that is not told from none, in the image's scale. Between 3e-3 and 3e-2 the error against the truth hardly changes (measured).
constexpr float kFloor = 1e-2f;
// exp(−1/2σ²) for a Gaussian window of σ = 0.7 pixels.
constexpr float kBeside = 0.36f;
// Most that a neighbour lends to the mean, times what is usual around it. 3 to 8 give the same error; without, it is a tenth more
// (docs/method.md).
constexpr float kMostLent = 4.0f;
// Deviation of differences over that of pixels where nobody knows their noise: as of the L2 solver.
constexpr float kUnknownAlpha = 0.4f;

// No row of the image is off by more than a hundredth of its noise, root mean square: 5 to 12 steps. The residual says nothing: beside a
// bright lamp it is small at once, and where weights span six decades it is that of the rows with little noise.
constexpr CgGoal kGoal{.row_error = 1e-2f};
constexpr int kMostSteps = 60;

// Means over windows of the deviations of a kind of rows that are known; negative where none is. Neighbours lend theirs, but an outlier, as
// which a firefly stands in its pixel and all differences beside it, lends no more than is usual around it.
class BlurredDeviation {
 public:
  BlurredDeviation(const std::vector<float>& deviation, int width, int height)
      : own_(width, height, 1), lent_(width, height, 1), known_(width, height, 1) {
    for_rows(height, [&](int y) {
      const float* from = deviation.data() + size_t(y) * width;
      for (int x = 0; x < width; ++x) {
        known_.row(y)[x] = is_finite(from[x]) ? 1.0f : 0.0f;
        own_.row(y)[x] = is_finite(from[x]) ? from[x] : 0.0f;
      }
    });
    for_rows(height, [&](int y) {
      for (int x = 0; x < width; ++x) lent_.row(y)[x] = std::min(own_.row(y)[x], kMostLent * level_around(x, y));
    });
  }

  void read_row(int y, float* out) const {
    for (int x = 0; x < own_.width(); ++x) {
      const float known = known_.row(y)[x] + beside(known_, x, y);
      out[x] = known > 0.0f ? (own_.row(y)[x] + beside(lent_, x, y)) / known : -1.0f;
    }
  }

 private:
  // Of the four lines through a row's value, the largest that both neighbours on it have: large within areas and along edges of noise,
  // small around an outlier, even where differences have two of them side by side.
  float level_around(int x, int y) const {
    const float *below = own_.row(y - 1) + x, *here = own_.row(y) + x, *above = own_.row(y + 1) + x;
    return std::max(
        {std::min(here[-1], here[1]), std::min(below[0], above[0]), std::min(below[-1], above[1]), std::min(below[1], above[-1])});
  }
  static float beside(const Field& f, int x, int y) {
    const float *below = f.row(y - 1) + x, *here = f.row(y) + x, *above = f.row(y + 1) + x;
    return kBeside * (here[-1] + here[1] + below[0] + above[0] + kBeside * (below[-1] + below[1] + above[-1] + above[1]));
  }

  Field own_, lent_, known_;
};

// Single precision tells a pixel's weight from its differences' down to a ratio of some 1e-6. Where differences were known far better
// than pixels, as under fireflies, the matrix would be singular and conjugate gradients diverge. So a difference is taken to be uncertain
// by this share of its pixel's noise, which loses nothing: it takes the mean of a million pixels to bring theirs down to it.
constexpr float kLeastShare = 1e-3f;

void weigh_rows(const std::vector<float>& deviations, const std::vector<float>& values, const GradientImages& images, float scale,
                float unknown, Field* weights) {
  const int w = images.width, stride = images.channels, shared = std::min(images.channels, 3);
  const BlurredDeviation deviation(deviations, w, images.height);
  for_rows(images.height, [&](int y) {
    float* row = weights->row(y);
    deviation.read_row(y, row);
    const float* value = values.data() + size_t(y) * w * stride;
    for (int x = 0; x < w; ++x, value += stride) {
      const float s = row[x] < 0.0f ? unknown : row[x] / scale;
      row[x] = is_complete(value, shared) ? 1.0f / (s * s + kFloor * kFloor) : 0.0f;
    }
  });
}

}  // namespace

void weigh_pixels_by_noise(const GradientImages& images, float scale, float unknown, Field* data) {
  weigh_rows(images.primal_deviation, images.primal, images, scale, unknown, data);
}

void weigh_differences_by_noise(const GradientImages& images, float scale, float unknown, Stencil* matrix) {
  weigh_rows(images.dx_deviation, images.dx, images, scale, kUnknownAlpha * unknown, &matrix->right);
  weigh_rows(images.dy_deviation, images.dy, images, scale, kUnknownAlpha * unknown, &matrix->up);
}

void limit_differences(const Field& data, Stencil* matrix) {
  for (Field* weights : {&matrix->right, &matrix->up}) {
    for_values(weights, [&](float& value, int x, int y, int) {
      if (data.row(y)[x] > 0.0f) value /= 1.0f + kLeastShare * kLeastShare * value / data.row(y)[x];
    });
  }
}

void solve_by_noise(const SolverPlanes& planes, const CancelTest& cancel, WeightedLeastSquares* system, Field* x, SolveReport* report) {
  const CgReport solve = system->solve(planes, kGoal, kMostSteps, cancel, x);
  ++report->outer_steps;
  add_solve(solve, report);
}

Minimum minimise_by_noise(const GradientImages& images, const CancelTest& cancel, SolveReport* report) {
  const int channels = std::min(images.channels, 3);
  const PoissonPlanes interleaved = planes_of(images, 0);
  const SolverPlanes planes = load_planes(interleaved, images.width, images.height, channels);
  Minimum result{WeightedLeastSquares(images.width, images.height, channels),
                 start_from_l2(interleaved, images.width, images.height, channels, kUnknownAlpha)};
  const float scale = robust_scale(planes.primal);
  weigh_pixels_by_noise(images, scale, 1.0f, &result.system.data_weights());
  weigh_differences_by_noise(images, scale, 1.0f, &result.system.matrix());
  limit_differences(result.system.data_weights(), &result.system.matrix());
  result.system.update();
  solve_by_noise(planes, cancel, &result.system, &result.solution, report);
  return result;
}

}  // namespace gradus
