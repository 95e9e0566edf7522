#include "reconstruct/poisson/minimise_by_noise.h"

#include <algorithm>

#include "base/rows.h"
#include "reconstruct/field_values.h"
#include "reconstruct/poisson/noise_weights.h"

namespace gradus::reconstruct {
namespace {

// Stops when the root mean square error of every row of the image is below a hundredth of its noise, after 5 to 12
// steps. The residual is no criterion: beside a bright light it is small at once, and where weights span six decades
// the rows with little noise dominate it.
constexpr CgGoal kNoiseGoal{.row_error = 1e-2f};
constexpr int kMaxNoiseSteps = 60;

void weigh_rows(const std::vector<float>& deviations, const std::vector<float>& values,
                const film::GradientImages& images, float scale, float unknown, Field* weights) {
  const int w = images.width, stride = images.channels, shared = std::min(images.channels, 3);
  const NoiseWeights by_noise(deviations, w, images.height);
  for_rows(images.height, [&](int y) {
    float* row = weights->row(y);
    by_noise.read_row(y, scale, unknown, row);
    const float* value = values.data() + size_t(y) * w * stride;
    for (int x = 0; x < w; ++x, value += stride) {
      if (!is_complete(value, shared)) row[x] = 0.0f;
    }
  });
}

}  // namespace

void weigh_pixels_by_noise(const film::GradientImages& images, float scale, float unknown, Field* data) {
  weigh_rows(images.primal_deviation, images.primal, images, scale, unknown, data);
}

void weigh_differences_by_noise(const film::GradientImages& images, float scale, float unknown, Stencil* matrix) {
  weigh_rows(images.dx_deviation, images.dx, images, scale, kUnknownAlpha * unknown, &matrix->right);
  weigh_rows(images.dy_deviation, images.dy, images, scale, kUnknownAlpha * unknown, &matrix->up);
}

void limit_differences(const Field& data, Stencil* matrix) {
  for (Field* weights : {&matrix->right, &matrix->up}) {
    for_values(weights, [&](float& value, int x, int y, int) { value = limited_difference(value, data.row(y)[x]); });
  }
}

void solve_by_noise(const SolverPlanes& planes, const CancelCheck& cancel, WeightedLeastSquares* system, Field* x,
                    SolveReport* report) {
  const CgReport solve = system->solve(planes, kNoiseGoal, kMaxNoiseSteps, cancel, x);
  ++report->outer_steps;
  add_solve(solve, report);
}

Minimum minimise_by_noise(const film::GradientImages& images, const CancelCheck& cancel, SolveReport* report) {
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

}  // namespace gradus::reconstruct
