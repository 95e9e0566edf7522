#include "reconstruct/poisson/fused_differences.h"

#include "base/fault.h"
#include "reconstruct/field_values.h"
#include "reconstruct/poisson/minimise_by_noise.h"
#include "reconstruct/poisson/reweigh.h"

namespace gradus::reconstruct {
namespace {

// The regression's errors are similar in pixels that lie close together, so a pixel counts less than an independent
// one.
constexpr float kSharedError = 8.0f;
// The regression's differences share no error within a window.
constexpr float kSharedDifference = 1.0f;
constexpr float kMinError = 1e-12f;
// Maximum number of solves after which the data weights of dark pixels are increased.
constexpr int kClampPasses = 2;

struct Step {
  int x, y;
};
constexpr Step kRightwards{1, 0}, kUpwards{0, 1};

bool has_next(const Field& field, Step step, int x, int y) {
  return x + step.x < field.width() && y + step.y < field.height();
}

// Adds the weight of the regression's difference to `weights`, those of the sampled differences. Returns the
// regression's share of the sum.
Field join_weights(const Field& error, Step step, Field* weights) {
  return make_field(error.width(), error.height(), [&](int x, int y) {
    if (!has_next(error, step, x, y)) return 0.0f;
    const float both = error.row(y)[x] + error.row(y + step.y)[x + step.x];
    const float own =
        1.0f /
        ((GRADUS_FAULT(regressed_difference_variance_times_4) ? 2.0f : 0.5f) * kSharedDifference * both + kMinError);
    float& weight = weights->row(y)[x];
    weight += own;
    return own / weight;
  });
}

// Blends the regression's difference into the sampled one; where none was sampled, it replaces it. Alpha has no scale.
void blend_differences(const Field& image, const Field& share, Step step, float scale, Field* sampled) {
  for_values(sampled, [&](float& value, int x, int y, int c) {
    if (c < 3) value /= scale;
    if (!has_next(image, step, x, y)) return;
    const float difference = image.row(y + step.y, c)[x + step.x] - image.row(y, c)[x], of_own = share.row(y)[x];
    value = of_own < 1.0f ? value + of_own * (difference - value) : difference;
  });
}

}  // namespace

FusedDifferences::FusedDifferences(const film::GradientImages& images, float scale, float unknown,
                                   const Field& regressed, const Field& error, const CancelCheck& cancel,
                                   SolveReport* report)
    : scale_(scale), system_(images.width, images.height, images.channels), solution_(regressed) {
  for_values(&system_.data_weights(),
             [&](float& value, int x, int y, int) { value = 1.0f / (kSharedError * error.row(y)[x] + kMinError); });
  weigh_differences_by_noise(images, scale, unknown, &system_.matrix());
  limit_differences(system_.data_weights(), &system_.matrix());
  share_x_ = join_weights(error, kRightwards, &system_.matrix().right);
  share_y_ = join_weights(error, kUpwards, &system_.matrix().up);
  const SolverPlanes planes = blend(images, regressed);
  const auto solve = [&] {
    system_.update();
    solve_by_noise(planes, cancel, &system_, &solution_, report);
  };
  solve();
  for (int i = 0; i < kClampPasses && clamp_dark_pixels(planes.primal, solution_, &system_); ++i) solve();
  downweight_differences(planes.primal, solution_, error, kSharedError, &system_);
  solve();
  if (GRADUS_FAULT(alpha_ignores_differences)) {
    for_values(&solution_, [&](float& v, int x, int y, int c) { v = c < 3 ? v : regressed.row(y, c)[x]; });
  }
}

Field FusedDifferences::apply(const film::GradientImages& images, const Field& regressed, const CancelCheck& cancel,
                              SolveReport* report) {
  Field solution = regressed;
  solve_by_noise(blend(images, regressed), cancel, &system_, &solution, report);
  return solution;
}

SolverPlanes FusedDifferences::blend(const film::GradientImages& images, const Field& regressed) const {
  SolverPlanes planes = load_planes(planes_of(images, 0), images.width, images.height, images.channels);
  blend_differences(regressed, share_x_, kRightwards, scale_, &planes.dx);
  blend_differences(regressed, share_y_, kUpwards, scale_, &planes.dy);
  planes.primal = regressed;
  return planes;
}

}  // namespace gradus::reconstruct
