#include "reconstruct/space_time/solve_window.h"

#include <algorithm>

#include "reconstruct/poisson/cg_loop.h"

namespace gradus::reconstruct {
namespace {

// Errors do not fall from the first step on: the start is 0, and where weights span decades the preconditioner's
// measure of the error is not quite the true one.
constexpr float kDivergence = 100.0f;

// Calls function(t, y, channel), which returns a double; their sums over all rows, per channel.
template <class Function>
Sums sum_window(const Frames& frames, const Function& function) {
  Sums sums(size_t(frames.front().channels()), 0.0);
  for (size_t t = 0; t < frames.size(); ++t) {
    const Sums more =
        sum_rows(frames[t].height(), frames[t].channels(), [&](int y, int c) { return function(t, y, c); });
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

// Of a window.
struct Steps {
  int width() const { return system.width(); }
  CgStart start() {
    const Sums bb = squared_norm(fields.r), minus_one(bb.size(), -1.0);
    system.multiply(*x, &fields.z);
    return {bb, add_scaled(minus_one, fields.z, &fields.r)};
  }
  CgProducts precondition() {
    CgProducts products{Sums(size_t(x->front().channels()), 0.0)};
    for (const RowSums& frame : preconditioner->apply(fields.r, &fields.z)) {
      const Sums more = frame.total();
      for (size_t c = 0; c < more.size(); ++c) products.rz[c] += more[c];
      products.largest_row = std::max(products.largest_row, frame.largest());
    }
    return products;
  }
  Sums direct(const Sums& factor) {
    reconstruct::direct(factor, fields.z, &fields.p);
    return system.multiply(fields.p, &fields.z);
  }
  Sums advance(Sums step) {
    add_scaled(step, fields.p, x);
    for (double& s : step) s = -s;
    return add_scaled(step, fields.z, &fields.r);
  }

  const SpaceTimeSystem& system;
  TimeLadder* preconditioner;
  WindowFields& fields;
  Frames* x;
};

}  // namespace

CgReport solve_window(const SpaceTimeSystem& system, TimeLadder* preconditioner, const CgGoal& goal, int max_steps,
                      const CancelCheck& cancel, WindowFields* fields, Frames* x) {
  return run_conjugate_gradient(Steps{system, preconditioner, *fields, x}, goal, kDivergence, max_steps, cancel);
}

}  // namespace gradus::reconstruct
