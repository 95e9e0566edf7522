#include "base/error.h"
#include "reconstruct/l1.h"
#include "reconstruct/solver.h"

namespace gradus {
namespace {

// From channel `first` on.
void apply_to_channels(const LinearOperator& solver, const GradientImages& images, int first, const CancelTest& cancel, float* result) {
  for (int c = first; c < images.channels && !cancel(); ++c) {
    const PoissonPlanes planes{images.primal.data() + c, images.dx.data() + c, images.dy.data() + c, size_t(images.channels)};
    solver.apply(planes, result + c);
  }
}

}  // namespace

std::vector<float> reconstruct(const GradientImages& images, uint32_t reconstruction, float alpha, const CancelTest& cancel,
                               SolveReport* report) {
  std::vector<float> result(images.primal.size());
  if (reconstruction == GRADUS_RECONSTRUCTION_L2) {
    apply_to_channels(*make_l2(images.width, images.height, alpha), images, 0, cancel, result.data());
  } else if (reconstruction == GRADUS_RECONSTRUCTION_L1) {
    const L1Solver solver(images, alpha, cancel, report);
    solver.read_solution(result.data(), size_t(images.channels));
    apply_to_channels(solver, images, solver.solved_channels(), cancel, result.data());  // alpha, by the same weights
  } else {
    throw unsupported("no solver for reconstruction " + std::to_string(reconstruction));
  }
  return result;
}

}  // namespace gradus
