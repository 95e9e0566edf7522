// Loop of preconditioned conjugate gradients, for vectors of any type, such as an image or a window of frames.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/rows.h"
#include "base/types.h"
#include "reconstruct/poisson/conjugate_gradient.h"

namespace gradus::reconstruct {

// All channels are solved side by side, each with its own step sizes. These functions calculate with sums per channel.

// Returns a / b by channel; 0 for a channel that is already solved, which then no longer changes.
inline Sums quotient(const Sums& a, const Sums& b) {
  Sums q(a.size());
  for (size_t c = 0; c < a.size(); ++c) q[c] = b[c] > 0.0 ? a[c] / b[c] : 0.0;
  return q;
}

// Returns the maximum over the channels of the relative residual. `rr` holds squared norms of the residual, `bb` of the
// right side.
inline float worst(const Sums& rr, const Sums& bb) {
  double result = 0.0;
  for (size_t c = 0; c < rr.size(); ++c) result = std::max(result, bb[c] > 0.0 ? rr[c] / bb[c] : rr[c]);
  return static_cast<float>(std::sqrt(result));
}

// Scalar products by channel: b·b and r·r at the start, and r·z in a step.
struct CgStart {
  Sums bb, rr;
};
struct CgProducts {
  Sums rz;
  double largest_row = 0.0;  // maximum of r·z over the rows and channels of all images
};

// Runs the loop. `Steps` holds the system and its vectors, and performs
//   CgStart start()                   r = b − A x
//   CgProducts precondition()         z ≈ A⁻¹ r
//   Sums direct(const Sums& factor)   p = z + factor p; returns p·Ap
//   Sums advance(const Sums& step)    x += step p, r −= step A p; returns r·r
//   int width()                       width of an image
// The loop stops when the row error exceeds `divergence` times its minimum: errors need not fall in every step, but
// beyond this factor single precision is exhausted and further steps make x worse.
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
