// L2 where some differences were not sampled: the same minimum, α²‖x−I‖² + ‖Dx−g‖² over the rows that are there, by multigrid. Which are
// there must not depend on the samples; then it is unbiased.
#pragma once

#include "reconstruct/solver.h"

namespace gradus {

// Whether a value is missing inside of the image.
bool has_gaps(const GradientImages& images);

std::vector<float> solve_l2_with_gaps(const GradientImages& images, float alpha, const CancelTest& cancel, SolveReport* report);

}  // namespace gradus
