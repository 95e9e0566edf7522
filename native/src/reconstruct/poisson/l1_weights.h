// Weights for one step of iteratively reweighted least squares.
#pragma once

#include <cmath>

#include "base/types.h"
#include "reconstruct/poisson/stencil.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {

// Computes the weight 1/√(e² + floor²) of a row from `sum`, the sum over the channels of its squared residual. The
// weight is 0 if the sum is not finite.
struct RowNorm {
  float factor;  // 1 / (channels · scale²)
  float floor_squared;
  float weight(float sum) const {
    const float w = 1.0f / std::sqrt(sum * factor + floor_squared);
    return is_finite(sum) ? w : 0.0f;
  }
  // Returns the norm of data rows, whose residuals are multiplied by α.
  RowNorm of_pixels(float alpha) const { return {factor * alpha * alpha, floor_squared}; }
};
inline RowNorm row_norm(int channels, float scale, float floor) {
  return {1.0f / (static_cast<float>(channels) * scale * scale), floor * floor};
}

// Computes the weights 1/√(e² + floor²) of all rows of the system at x, where e is the row's residual divided by
// `scale`. The Huber floor keeps the systems solvable; a smaller one makes the result worse (measured). Rows that are
// not finite get weight 0. The weights of the data rows go to `data`, those of the differences to `right` and `up` of
// `matrix`.
void reweight(const SolverPlanes& planes, const Field& x, float alpha, float scale, float floor, Field* data,
              Stencil* matrix);

}  // namespace gradus::reconstruct
