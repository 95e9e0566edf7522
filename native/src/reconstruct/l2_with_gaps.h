// L2 where some differences were not sampled: the same minimum, α²‖x−I‖² + ‖Dx−g‖² over the rows that are there, by
// multigrid. Which are there must not depend on the samples; then it is unbiased.
#pragma once

#include "reconstruct/solver.h"

namespace gradus::reconstruct {

std::vector<float> solve_l2_with_gaps(const film::GradientImages& images, float alpha, const CancelCheck& cancel,
                                      SolveReport* report);

}  // namespace gradus::reconstruct
