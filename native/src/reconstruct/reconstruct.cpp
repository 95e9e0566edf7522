#include "base/error.h"
#include "reconstruct/l1.h"
#include "reconstruct/solver.h"

namespace gradus {
namespace {

PoissonPlanes planes_of(const GradientImages& images, int channel) {
  return {images.primal.data() + channel, images.dx.data() + channel, images.dy.data() + channel, size_t(images.channels)};
}

}  // namespace

std::vector<float> reconstruct(const GradientImages& images, uint32_t reconstruction, float alpha, const CancelTest& cancel,
                               SolveReport* report) {
  std::vector<float> result(images.primal.size());
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) {
    const std::unique_ptr<LinearOperator> l2 = make_l2(images.width, images.height, alpha);
    for (int c = 0; c < images.channels && !cancel(); ++c) l2->apply(planes_of(images, c), result.data() + c);
  } else if (reconstruction == GRADUS_RECONSTRUCTION_L1) {
    const L1Solver l1(images, alpha, cancel, report);
    for (int c = 0; c < images.channels && !cancel(); ++c) {
      if (c < l1.solved_channels()) {
        l1.read_solution(planes_of(images, c), c, result.data() + c);
      } else {
        l1.apply(planes_of(images, c), result.data() + c);  // alpha, by the same weights
      }
    }
  } else {
    throw unsupported("no solver for reconstruction " + std::to_string(reconstruction));
  }
  return result;
}

}  // namespace gradus
