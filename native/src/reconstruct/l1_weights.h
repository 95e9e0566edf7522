// Weights of one step of iteratively reweighted least squares.
#pragma once

#include "reconstruct/solver_planes.h"
#include "reconstruct/stencil.h"

namespace gradus {

// Weights 1/√(e² + floor²) of every row of the system at x, e being the row's residual over the scale: the Huber floor keeps the systems
// solvable, and less of it makes the result worse (measured). Rows that are not finite get weight 0.
// The data rows' weights go to `data`, those of the differences to `matrix`'s right and up.
void reweight(const SolverPlanes& planes, const Field& x, float alpha, float scale, float floor, Field* data, Stencil* matrix);

}  // namespace gradus
