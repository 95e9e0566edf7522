// Conjugate gradients with a multigrid preconditioner, all channels side by side, each with its own step sizes.
#pragma once

#include "reconstruct/multigrid.h"
#include "reconstruct/solver.h"

namespace gradus {

struct CgReport {
  int steps = 0;
  float residual = 0.0f;  // ‖b - Ax‖ / ‖b‖, the worst channel
};

// Work space, kept from solve to solve.
struct CgFields {
  CgFields(int width, int height, int channels) : r(width, height, channels), z(r), p(r), next_p(r) {}
  Field r, z, p, next_p;
};

// Improves x until the residual is below `tolerance` or `most_steps` are done. Floats with sums in double.
CgReport conjugate_gradient(Multigrid* preconditioner, const Field& b, Field* x, CgFields* fields, float tolerance, int most_steps,
                            const CancelTest& cancel);

}  // namespace gradus
