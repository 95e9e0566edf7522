#include "reconstruct/space_time/solve_window.h"

#include <algorithm>
#include <cmath>

#include "base/types.h"
#include "reconstruct/channel_sums.h"

namespace gradus {
namespace {

// Errors fall, but not from step to step, and not from the first on: the start is 0, and where weights span decades the preconditioner's
// measure of the error is not quite the true one. Beyond this factor single precision has been lost, and what follows is worse.
constexpr float kDivergence = 100.0f;

// Calls function(t, y, channel), which returns a double; their sums over all rows, per channel.
template <class Function>
Sums sum_window(const Frames& frames, const Function& function) {
  Sums sums(size_t(frames.front().channels()), 0.0);
  for (size_t t = 0; t < frames.size(); ++t) {
    const Sums more = sum_rows(frames[t].height(), frames[t].channels(), [&](int y, int c) { return function(t, y, c); });
    for (size_t c = 0; c < sums.size(); ++c) sums[c] += more[c];
  }
  return sums;
}

Sums squared_norm(const Frames& a) {
  return sum_window(a, [&](size_t t, int y, int c) { return dot_row(a[t].row(y, c), a[t].row(y, c), a[t].width()); });
}

// to += factor · from; returns to·to.
Sums add_scaled(const Sums& factor, const Frames& from, Frames* to) {
  return sum_window(from, [&](size_t t, int y, int c) {
    const auto f = static_cast<float>(factor[size_t(c)]);
    const float* a = from[t].row(y, c);
    float* b = (*to)[t].row(y, c);
    for (int x = 0; x < from[t].width(); ++x) b[x] += f * a[x];
    return dot_row(b, b, from[t].width());
  });
}

// p = z + factor · p
void direct(const Sums& factor, const Frames& z, Frames* p) {
  for (size_t t = 0; t < z.size(); ++t) {
    for_rows(z[t].height(), [&](int y) {
      for (int c = 0; c < z[t].channels(); ++c) {
        const auto f = static_cast<float>(factor[size_t(c)]);
        const float* a = z[t].row(y, c);
        float* b = (*p)[t].row(y, c);
        for (int x = 0; x < z[t].width(); ++x) b[x] = a[x] + f * b[x];
      }
    });
  }
}

}  // namespace

CgReport solve_window(const SpaceTimeSystem& system, TimeLadder* preconditioner, const CgGoal& goal, int most_steps,
                      const CancelTest& cancel, WindowFields* fields, Frames* x) {
  auto& [r, p, z] = *fields;
  const Sums bb = squared_norm(r), minus_one(bb.size(), -1.0);
  system.multiply(*x, &z);
  CgReport report;
  report.residual = worst(add_scaled(minus_one, z, &r), bb);
  report.reached = report.residual <= goal.residual;
  Sums rz_before(bb.size(), 0.0);
  float best_error = kInfinity;
  for (; report.steps < most_steps && !report.reached && !cancel(); ++report.steps) {
    Sums rz(bb.size(), 0.0);
    double largest = 0.0;
    for (const RowSums& frame : preconditioner->apply(r, &z)) {
      const Sums more = frame.total();
      for (size_t c = 0; c < rz.size(); ++c) rz[c] += more[c];
      largest = std::max(largest, frame.largest());
    }
    direct(quotient(rz, rz_before), z, &p);
    rz_before = rz;
    const Sums pap = system.multiply(p, &z);
    add_scaled(quotient(rz, pap), p, x);
    report.residual = worst(add_scaled(quotient(rz, pap, -1.0), z, &r), bb);
    // The preconditioner is nearly A⁻¹, so r·z is nearly the square of the error before this step.
    report.row_error = static_cast<float>(std::sqrt(largest / system.width()));
    report.reached = report.residual <= goal.residual || report.row_error <= goal.row_error;
    best_error = std::min(best_error, report.row_error);
    if (report.row_error > kDivergence * best_error) break;
  }
  return report;
}

}  // namespace gradus
