// The parts of one step of iteratively reweighted least squares.
#pragma once

#include "reconstruct/solver.h"
#include "reconstruct/stencil.h"

namespace gradus {

// Primal and differences of some channels, as the solver's fields.
struct L1Planes {
  L1Planes(int width, int height, int channels)
      : primal(width, height, channels), dx(width, height, channels), dy(width, height, channels) {}
  Field primal, dx, dy;
};

// Takes channels [0, channels) from interleaved planes.
L1Planes load_planes(const PoissonPlanes& planes, int width, int height, int channels);
// Scale of the image: the median of the luminances that are not 0; 1 for a black image. Residuals are measured in it.
float robust_scale(const L1Planes& planes);

// Weights 1/√(e² + floor²) of every row of the system at x, e being the row's residual over the scale: the Huber floor keeps the systems
// solvable, and less of it makes the result worse (measured). Rows that are not finite get weight 0.
// The data rows' weights W_d go to `data`, those of the differences W_g to `matrix`, which becomes A = W_d + Dᵀ W_g D.
void reweight(const L1Planes& planes, const Field& x, float alpha, float scale, float floor, Field* data, Stencil* matrix);
// W_d I + Dᵀ W_g g
void right_side(const Field& data, const Stencil& matrix, const L1Planes& planes, Field* b);

}  // namespace gradus
