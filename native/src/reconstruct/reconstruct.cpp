#include "base/error.h"
#include "reconstruct/solver.h"

namespace gradus {

std::vector<float> reconstruct(const GradientImages& images, uint32_t reconstruction, float alpha, const CancelTest& cancel,
                               SolveReport* report) {
  std::unique_ptr<LinearOperator> solver;
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) {
    solver = make_l2(images.width, images.height, alpha);
  } else if (reconstruction == GRADUS_RECONSTRUCTION_L1) {
    solver = make_l1(images, alpha, cancel, report);
  } else {
    throw unsupported("no solver for reconstruction " + std::to_string(reconstruction));
  }
  std::vector<float> result(images.primal.size());
  for (int c = 0; c < images.channels && !cancel(); ++c) {
    const PoissonPlanes planes{images.primal.data() + c, images.dx.data() + c, images.dy.data() + c, size_t(images.channels)};
    solver->apply(planes, result.data() + c);
  }
  return result;
}

}  // namespace gradus
