// Red-black Gauss-Seidel on a cycle's finest grid, whose pixels couple with four neighbours: red ones (x + y even) with
// black ones alone, so that half a sweep solves all equations of one colour. It leaves far less of what is rough than
// Jacobi does, for the same arithmetic.
#pragma once

#include "base/rows.h"
#include "reconstruct/interpolation.h"

namespace gradus::reconstruct {

// coarse = Pᵀ (b − A x), x what a sweep over red, then black pixels makes of 0.
void restrict_after_sweep(const Stencil& a, const Interpolation& p, const Field& b, Field* coarse);

// z = what a sweep over black, then red pixels makes of x + P coarse: the transpose of the way down, so that a cycle is
// symmetric. Returns b·z of each row.
RowSums sweep_interpolated(const Stencil& a, const Interpolation& p, const Field& b, const Field& coarse, Field* z);

}  // namespace gradus::reconstruct
