#include "reconstruct/twiced_solver.h"

namespace gradus::reconstruct {

void TwicedSolver::apply(const PoissonPlanes& planes, float* out) const {
  const Field& x = minimum_.solution;
  minimum_.system.apply(planes, start_from_l2(planes, x.width(), x.height(), 1, alpha_), out);
  twicing_.apply(planes, out);
}

void TwicedSolver::read_solution(const PoissonPlanes& planes, int channel, float* out) const {
  store_channel(minimum_.solution, channel, planes.stride, out);
  twicing_.apply(planes, out);
}

}  // namespace gradus::reconstruct
