#include "reconstruct/l2_with_gaps.h"

#include <algorithm>

#include "base/rows.h"
#include "reconstruct/weighted_least_squares.h"

namespace gradus::reconstruct {
namespace {

constexpr CgGoal kGoal{.residual = 1e-6f};
constexpr int kMaxSteps = 100;

// Writes `weight` for each pixel whose value is known in all channels, and 0 for the others.
void weigh(const std::vector<float>& values, int channels, int width, int y, float weight, float* weights) {
  const float* value = values.data() + size_t(y) * size_t(width) * size_t(channels);
  for (int x = 0; x < width; ++x, value += channels) weights[x] = is_complete(value, channels) ? weight : 0.0f;
}

}  // namespace

std::vector<float> solve_l2_with_gaps(const film::GradientImages& images, float alpha, const CancelCheck& cancel,
                                      SolveReport* report) {
  const int w = images.width, h = images.height, channels = images.channels;
  WeightedLeastSquares system(w, h, channels);
  for_rows(h, [&](int y) {
    weigh(images.primal, channels, w, y, alpha * alpha, system.data_weights().row(y));
    weigh(images.dx, channels, w, y, 1.0f, system.matrix().right.row(y));
    weigh(images.dy, channels, w, y, 1.0f, system.matrix().up.row(y));
  });
  system.update();
  const PoissonPlanes interleaved = planes_of(images, 0);
  Field x = start_from_l2(interleaved, w, h, channels, alpha);
  const CgReport solve = system.solve(load_planes(interleaved, w, h, channels), kGoal, kMaxSteps, cancel, &x);
  add_solve(solve, report);
  return interleave(x);
}

}  // namespace gradus::reconstruct
