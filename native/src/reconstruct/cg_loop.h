// The loop of preconditioned conjugate gradients, of whatever its vectors are: of an image, or of a window of frames.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"
#include "reconstruct/channel_sums.h"
#include "reconstruct/conjugate_gradient.h"

namespace gradus::reconstruct {

// Sums of products of vectors.
struct CgStart {
  Sums bb, rr;
};
struct CgProducts {
  Sums rz;
  double largest_row = 0.0;  // of any image
};

// Steps has the system and its vectors, and
//   CgStart start()                   r = b − A x
//   CgProducts precondition()         z ≈ A⁻¹ r
//   Sums direct(const Sums& factor)   p = z + factor p; p·Ap
//   Sums advance(const Sums& step)    x += step p, r −= step A p; r·r
//   int width()                       of an image.
// divergence: errors fall, but not from step to step. Beyond this factor single precision has been lost, and what
// follows is worse.
template <class Steps>
CgReport run_conjugate_gradient(Steps steps, const CgGoal& goal, float divergence, int max_steps,
                                const CancelCheck& cancel) {
  const auto [bb, rr] = steps.start();
  CgReport report;
  report.residual = worst(rr, bb);
  report.reached = report.residual <= goal.residual;
  Sums rz_before(bb.size(), 0.0);
  float best_error = kInfinity;
  for (; report.steps < max_steps && !report.reached && !cancel(); ++report.steps) {
    const auto [rz, largest_row] = steps.precondition();
    const Sums pap = steps.direct(quotient(rz, rz_before));
    rz_before = rz;
    report.residual = worst(steps.advance(quotient(rz, pap)), bb);
    // The preconditioner is nearly A⁻¹, so r·z is nearly the square of the error before this step.
    report.row_error = static_cast<float>(std::sqrt(largest_row / steps.width()));
    report.reached = report.residual <= goal.residual || report.row_error <= goal.row_error;
    best_error = std::min(best_error, report.row_error);
    if (report.row_error > divergence * best_error) break;
  }
  return report;
}

}  // namespace gradus::reconstruct
