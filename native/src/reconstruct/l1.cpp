#include "reconstruct/l1.h"

#include "reconstruct/rows.h"

namespace gradus {

void L1Solver::apply(const PoissonPlanes& planes, float* out) const {
  minimiser_.apply(planes, out);
  twicing_.apply(planes, out);
}

void L1Solver::read_solution(const PoissonPlanes& planes, int channel, float* out) const {
  const Field& x = minimiser_.solution();
  for_rows(x.height(), [&](int y) {
    const float* row = x.row(y, channel);
    float* to = out + size_t(y) * x.width() * planes.stride;
    for (int i = 0; i < x.width(); ++i, to += planes.stride) *to = row[i];
  });
  twicing_.apply(planes, out);
}

std::unique_ptr<LinearOperator> make_l1(const GradientImages& images, float alpha, const CancelTest& cancel, SolveReport* report) {
  return std::make_unique<L1Solver>(images, alpha, cancel, report);
}

}  // namespace gradus
