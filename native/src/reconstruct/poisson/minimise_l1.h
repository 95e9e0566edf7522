// Minimises Σ α‖x−I‖ + ‖Dx−g‖ with the norm of a pixel's RGB (thesis eq. 5.13 with k = 1) by iteratively reweighted
// least squares.
#pragma once

#include "reconstruct/poisson/weighted_least_squares.h"

namespace gradus::reconstruct {

// Estimates the weights from the first three channels of `images`, which share them, and freezes them. `report`
// collects the steps and the residual of all solves.
Minimum minimise_l1(const film::GradientImages& images, float alpha, const CancelCheck& cancel, SolveReport* report);

}  // namespace gradus::reconstruct
