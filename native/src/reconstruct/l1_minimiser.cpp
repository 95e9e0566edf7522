#include "reconstruct/l1_minimiser.h"

#include <algorithm>

#include "reconstruct/conjugate_gradient.h"
#include "reconstruct/l1_weights.h"
#include "reconstruct/rows.h"

namespace gradus {
namespace {

// Outer steps lower the floor from the first to the last value; the error against the truth is best after 5 to 6 such steps and rises
// below about 1e-3 of the image's scale (measured; 2e-3 gives the same error as 1e-3 for two thirds of the time).
constexpr float kFirstFloor = 0.05f;
constexpr float kLastFloor = 2e-3f;
constexpr float kFloorFactor = 0.45f;
constexpr int kMostOuterSteps = 8;
// Weights need no exact solution: they change with the next step.
constexpr float kOuterTolerance = 1e-2f;
constexpr int kMostInnerSteps = 4;
// A smaller one changes the error against the truth by less than 0.01 % (measured).
constexpr float kFinalTolerance = 1e-4f;
constexpr int kMostFinalSteps = 60;
// The frozen operator is linear as far as it is solved: parts that add up must add up to much better than the noise.
constexpr float kOperatorTolerance = 1e-6f;
constexpr int kMostOperatorSteps = 200;

void store(const Field& from, int channel, size_t stride, float* out) {
  for_rows(from.height(), [&](int y) {
    const float* row = from.row(y, channel);
    float* to = out + size_t(y) * from.width() * stride;
    for (int x = 0; x < from.width(); ++x, to += stride) *to = row[x];
  });
}

// The exact L2 solution: where the reweighting starts.
Field start_from_l2(const PoissonPlanes& planes, int width, int height, int channels, float alpha) {
  Field x(width, height, channels);
  const std::unique_ptr<LinearOperator> l2 = make_l2(width, height, alpha);
  std::vector<float> plane(size_t(width) * height * planes.stride);
  for (int c = 0; c < channels; ++c) {
    const PoissonPlanes one{planes.primal + c, planes.dx + c, planes.dy + c, planes.stride};
    l2->apply(one, plane.data());
    for_rows(height, [&](int y) {
      const float* from = plane.data() + size_t(y) * width * planes.stride;
      float* to = x.row(y, c);
      for (int i = 0; i < width; ++i, from += planes.stride) to[i] = *from;
    });
  }
  return x;
}

}  // namespace

L1Minimiser::L1Minimiser(const GradientImages& images, float alpha, const CancelTest& cancel, SolveReport* report)
    : multigrid_(images.width, images.height, std::min(images.channels, 3)), data_weights_(images.width, images.height, 1), alpha_(alpha) {
  const int channels = std::min(images.channels, 3);
  const PoissonPlanes interleaved{images.primal.data(), images.dx.data(), images.dy.data(), size_t(images.channels)};
  const L1Planes planes = load_planes(interleaved, images.width, images.height, channels);
  solution_ = start_from_l2(interleaved, images.width, images.height, channels, alpha);
  const float scale = robust_scale(planes);
  CgFields fields(images.width, images.height, channels);
  Field b(images.width, images.height, channels);
  float floor = kFirstFloor;
  int outer_steps = 0;
  for (bool last = false; !last && !cancel(); floor = std::max(floor * kFloorFactor, kLastFloor)) {
    ++outer_steps;
    last = floor <= kLastFloor || outer_steps == kMostOuterSteps;
    reweight(planes, solution_, alpha, scale, floor, &data_weights_, &multigrid_.matrix());
    multigrid_.update();
    right_side(data_weights_, multigrid_.matrix(), planes, &b);
    const CgReport inner = conjugate_gradient(&multigrid_, b, &solution_, &fields, last ? kFinalTolerance : kOuterTolerance,
                                              last ? kMostFinalSteps : kMostInnerSteps, cancel);
    report->inner_steps += inner.steps;
    if (last) report->residual = std::max(report->residual, inner.residual);
  }
  report->outer_steps += outer_steps;
  report->hit_cap = report->hit_cap || report->residual > kFinalTolerance;
}

void L1Minimiser::apply(const PoissonPlanes& planes, float* out) const {
  const int w = data_weights_.width(), h = data_weights_.height();
  const L1Planes loaded = load_planes(planes, w, h, 1);
  Field x = start_from_l2(planes, w, h, 1, alpha_);
  Multigrid multigrid(w, h, 1);
  multigrid.matrix() = multigrid_.matrix();
  multigrid.update();
  Field b(w, h, 1);
  right_side(data_weights_, multigrid.matrix(), loaded, &b);
  CgFields fields(w, h, 1);
  conjugate_gradient(&multigrid, b, &x, &fields, kOperatorTolerance, kMostOperatorSteps, [] { return false; });
  store(x, 0, planes.stride, out);
}

}  // namespace gradus
