// Conjugate gradients with a multigrid preconditioner, all channels side by side, each with its own step sizes.
#pragma once

#include "reconstruct/multigrid.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

struct CgReport {
  int steps = 0;
  float residual = 0.0f;   // ‖b - Ax‖ / ‖b‖, the worst channel
  float row_error = 0.0f;  // see CgGoal; of the last iterate but one
  bool reached = false;
};

// When x is good enough: one of the two. The residual counts what is bright, whatever happens elsewhere. The row error
// counts errors by the weights: √((x − x*)ᵀA(x − x*)/n) for the n pixels of the worst row of an image, so if weights
// are 1/variance, in deviations of the noise.
struct CgGoal {
  float residual = 0.0f;
  float row_error = 0.0f;
};

// Work space, kept from solve to solve.
struct CgFields {
  CgFields(int width, int height, int channels) : r(width, height, channels), z(r), p(r), next_p(r) {}
  Field r, z, p, next_p;
};

// Improves x until the goal is reached or `max_steps` are done. Floats with sums in double.
CgReport conjugate_gradient(Multigrid* preconditioner, const Field& b, Field* x, CgFields* fields, const CgGoal& goal,
                            int max_steps, const CancelCheck& cancel);

}  // namespace gradus::reconstruct
