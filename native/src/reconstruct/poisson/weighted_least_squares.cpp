#include "reconstruct/poisson/weighted_least_squares.h"

#include <algorithm>

#include "base/rows.h"
#include "base/types.h"
#include "reconstruct/poisson/l2.h"

namespace gradus::reconstruct {
namespace {

// The operator is only linear to the accuracy of the solve, so this must be far below the noise for components to add
// up.
constexpr CgGoal kOperatorGoal{.residual = 1e-6f};
constexpr int kMaxOperatorSteps = 200;

// Replaces a missing value. The weight of its row is 0, so any finite value would do.
float finite_or_zero(float v) { return is_finite(v) ? v : 0.0f; }

// Computes b = W_d I + Dᵀ W_g g.
void right_side(const Field& data_weights, const Stencil& matrix, const SolverPlanes& planes, Field* b) {
  const int w = data_weights.width(), h = data_weights.height(), channels = planes.primal.channels();
  for_rows(h, [&](int y) {
    const float *data = data_weights.row(y), *right = matrix.right.row(y), *up = matrix.up.row(y);
    const float* down = y > 0 ? matrix.up.row(y - 1) : nullptr;
    for (int c = 0; c < channels; ++c) {
      const float *primal = planes.primal.row(y, c), *dx = planes.dx.row(y, c), *dy = planes.dy.row(y, c);
      const float* below = y > 0 ? planes.dy.row(y - 1, c) : nullptr;
      float* to = b->row(y, c);
      float flux = 0.0f;  // of the difference from the left
      for (int i = 0; i < w; ++i) {
        const float out = right[i] * finite_or_zero(dx[i]);
        to[i] = data[i] * finite_or_zero(primal[i]) + flux - out - up[i] * finite_or_zero(dy[i]);
        flux = out;
      }
      if (!down) continue;
      for (int i = 0; i < w; ++i) to[i] += down[i] * finite_or_zero(below[i]);
    }
  });
}

}  // namespace

void WeightedLeastSquares::update() {
  Stencil& matrix = multigrid_.matrix();
  const int w = matrix.width(), h = matrix.height();
  for (int y = 0; y < h; ++y) matrix.right.row(y)[w - 1] = 0.0f;
  std::fill_n(matrix.up.row(h - 1), w, 0.0f);
  for_rows(h, [&](int y) {
    const float *data = data_weights_.row(y), *right = matrix.right.row(y), *up = matrix.up.row(y),
                *down = matrix.up.row(y - 1);
    float* diagonal = matrix.diagonal.row(y);
    for (int x = 0; x < w; ++x) diagonal[x] = data[x] + right[x] + right[x - 1] + up[x] + down[x];
  });
  multigrid_.update();
}

CgReport WeightedLeastSquares::solve(const SolverPlanes& planes, const CgGoal& goal, int max_steps,
                                     const CancelCheck& cancel, Field* x) {
  right_side(data_weights_, multigrid_.matrix(), planes, &b_);
  return conjugate_gradient(&multigrid_, b_, x, &fields_, goal, max_steps, cancel);
}

void WeightedLeastSquares::apply(const PoissonPlanes& planes, const Field& start, float* out) const {
  const int w = data_weights_.width(), h = data_weights_.height();
  WeightedLeastSquares one(w, h, 1);
  one.data_weights_ = data_weights_;
  one.matrix() = multigrid_.matrix();
  one.multigrid_.update();
  Field x = start;
  one.solve(
      load_planes(planes, w, h, 1), kOperatorGoal, kMaxOperatorSteps, [] { return false; }, &x);
  store_channel(x, 0, planes.stride, out);
}

void add_solve(const CgReport& solve, SolveReport* report) {
  report->inner_steps += solve.steps;
  report->residual = std::max(report->residual, solve.residual);
  report->hit_cap = report->hit_cap || !solve.reached;
}

Field start_from_l2(const PoissonPlanes& planes, int width, int height, int channels, float alpha) {
  Field x(width, height, channels);
  const auto take = [&](int y, const float* row) {
    for (int c = 0; c < channels; ++c) std::copy_n(row + size_t(c) * size_t(width), width, x.row(y, c));
  };
  const std::unique_ptr<float[]> work(new float[size_t(width) * size_t(height) * size_t(channels)]);
  solve_l2(width, height, channels, alpha, rows_of(planes, width, channels), take, work.get());
  return x;
}

}  // namespace gradus::reconstruct
