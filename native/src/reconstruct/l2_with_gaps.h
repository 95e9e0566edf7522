// L2 for images in which some differences were not sampled. It minimises the same sum, α²‖x−I‖² + ‖Dx−g‖², over the
// rows that exist, by multigrid. It is unbiased if the samples do not decide which rows exist.
#pragma once

#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// Returns width·height·channels values. Missing values are not finite.
std::vector<float> solve_l2_with_gaps(const film::GradientImages& images, float alpha, const CancelCheck& cancel,
                                      SolveReport* report);

}  // namespace gradus::reconstruct
