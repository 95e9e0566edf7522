// Weights of one step of iteratively reweighted least squares.
#pragma once

#include <cmath>

#include "base/types.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/stencil.h"

namespace gradus::reconstruct {

// 1/√(e² + floor²) from the sum over channels of a row's squared residual; 0 if that is not finite.
struct RowNorm {
  float factor;  // 1 / (channels · scale²)
  float floor_squared;
  float weight(float sum) const {
    const float w = 1.0f / std::sqrt(sum * factor + floor_squared);
    return is_finite(sum) ? w : 0.0f;
  }
  // The residual of a pixel counts α times.
  RowNorm of_pixels(float alpha) const { return {factor * alpha * alpha, floor_squared}; }
};
inline RowNorm row_norm(int channels, float scale, float floor) {
  return {1.0f / (static_cast<float>(channels) * scale * scale), floor * floor};
}

// Weights 1/√(e² + floor²) of every row of the system at x, e being the row's residual over the scale: the Huber floor
// keeps the systems solvable, and less of it makes the result worse (measured). Rows that are not finite get weight 0.
// The data rows' weights go to `data`, those of the differences to `matrix`'s right and up.
void reweight(const SolverPlanes& planes, const Field& x, float alpha, float scale, float floor, Field* data,
              Stencil* matrix);

}  // namespace gradus::reconstruct
