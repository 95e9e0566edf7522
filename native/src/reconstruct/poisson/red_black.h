// Red-black Gauss-Seidel on the finest grid of a cycle, where pixels couple with four neighbours. Red pixels (x + y
// even) then couple with black ones only, so that half a sweep solves all equations of one colour. It removes far more
// of the high frequencies than Jacobi does, for the same arithmetic.
#pragma once

#include "base/rows.h"
#include "reconstruct/poisson/interpolation.h"

namespace gradus::reconstruct {

// Computes coarse = Pᵀ (b − A x), where x is the result of a sweep from 0 over the red, then the black pixels.
void restrict_after_sweep(const Stencil& a, const Interpolation& p, const Field& b, Field* coarse);

// Computes z, the result of a sweep over the black, then the red pixels from x + P coarse, where x is that of
// restrict_after_sweep(). The order is reversed so that the cycle is symmetric. Returns b·z of each row.
RowSums sweep_interpolated(const Stencil& a, const Interpolation& p, const Field& b, const Field& coarse, Field* z);

}  // namespace gradus::reconstruct
