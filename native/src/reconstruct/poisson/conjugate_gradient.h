// Conjugate gradients with a multigrid preconditioner. All channels are solved side by side, each with its own step
// sizes.
#pragma once

#include "base/cancel_check.h"
#include "reconstruct/poisson/multigrid.h"

namespace gradus::reconstruct {

struct CgReport {
  int steps = 0;
  float residual = 0.0f;   // maximum of ‖b - Ax‖ / ‖b‖ over the channels
  float row_error = 0.0f;  // see CgGoal; belongs to the iterate before the last
  bool reached = false;
};

// Conditions under which the iteration stops; one of them suffices. The residual is dominated by bright pixels. The row
// error measures errors by the weights: it is the maximum over the image's rows of √((x − x*)ᵀA(x − x*)/n) for the n
// pixels of a row. If the weights are 1/variance, its unit is the standard deviation of the noise.
struct CgGoal {
  float residual = 0.0f;
  float row_error = 0.0f;
};

// Work space, reused from solve to solve.
struct CgFields {
  CgFields(int width, int height, int channels) : r(width, height, channels), z(r), p(r), next_p(r) {}
  Field r, z, p, next_p;
};

// Improves x until the goal is reached or `max_steps` are done. Values are floats; sums are computed in double
// precision.
CgReport conjugate_gradient(Multigrid* preconditioner, const Field& b, Field* x, CgFields* fields, const CgGoal& goal,
                            int max_steps, const CancelCheck& cancel);

}  // namespace gradus::reconstruct
