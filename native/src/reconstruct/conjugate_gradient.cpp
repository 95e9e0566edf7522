#include "reconstruct/conjugate_gradient.h"

#include <algorithm>
#include <cmath>

#include "reconstruct/rows.h"

namespace gradus {
namespace {

using Sums = std::vector<double>;

Sums dot(const Field& a, const Field& b) {
  return sum_rows(a.height(), a.channels(), [&](int y, int c) { return dot_row(a.row(y, c), b.row(y, c), a.width()); });
}

// r = b - A x; returns r·r.
Sums residual(const WeightedSystem& a, const Field& b, const Field& x, Field* r) {
  return sum_rows(a.height(), b.channels(), [&](int y, int c) {
    float* to = r->row(y, c);
    apply_row(a, x, y, c, to);
    const float* from = b.row(y, c);
    for (int i = 0; i < a.width(); ++i) to[i] = from[i] - to[i];
    return dot_row(to, to, a.width());
  });
}

// out = A p; returns p·Ap.
Sums product(const WeightedSystem& a, const Field& p, Field* out) {
  return sum_rows(a.height(), p.channels(), [&](int y, int c) {
    float* to = out->row(y, c);
    apply_row(a, p, y, c, to);
    return dot_row(to, p.row(y, c), a.width());
  });
}

// x += step p; r -= step q; returns r·r.
Sums advance(const Sums& step, const Field& p, const Field& q, Field* x, Field* r) {
  return sum_rows(x->height(), x->channels(), [&](int y, int c) {
    const auto s = static_cast<float>(step[c]);
    float* to_x = x->row(y, c);
    float* to_r = r->row(y, c);
    const float* from_p = p.row(y, c);
    const float* from_q = q.row(y, c);
    for (int i = 0; i < x->width(); ++i) {
      to_x[i] += s * from_p[i];
      to_r[i] -= s * from_q[i];
    }
    return dot_row(to_r, to_r, x->width());
  });
}

// p = z + factor p
void turn(const Field& z, const Sums& factor, Field* p) {
  for_rows(z.height(), [&](int y) {
    for (int c = 0; c < z.channels(); ++c) {
      const auto f = static_cast<float>(factor[c]);
      const float* from = z.row(y, c);
      float* to = p->row(y, c);
      for (int i = 0; i < z.width(); ++i) to[i] = from[i] + f * to[i];
    }
  });
}

Sums quotient(const Sums& a, const Sums& b) {
  Sums q(a.size());
  for (size_t c = 0; c < a.size(); ++c) q[c] = b[c] > 0.0 ? a[c] / b[c] : 0.0;  // a channel that is solved stands still
  return q;
}

float worst(const Sums& rr, const Sums& bb) {
  double result = 0.0;
  for (size_t c = 0; c < rr.size(); ++c) result = std::max(result, bb[c] > 0.0 ? rr[c] / bb[c] : rr[c]);
  return static_cast<float>(std::sqrt(result));
}

}  // namespace

CgReport conjugate_gradient(Multigrid* preconditioner, const Field& b, Field* x, CgFields* fields, float tolerance, int most_steps,
                            const CancelTest& cancel) {
  const WeightedSystem& a = preconditioner->system();
  auto& [r, z, p, q] = *fields;
  const Sums bb = dot(b, b);
  CgReport report;
  report.residual = worst(residual(a, b, *x, &r), bb);
  Sums rz_before(bb.size(), 0.0);
  for (; report.steps < most_steps && report.residual > tolerance && !cancel(); ++report.steps) {
    preconditioner->cycle(r, &z);
    const Sums rz = dot(r, z);
    turn(z, quotient(rz, rz_before), &p);
    rz_before = rz;
    const Sums step = quotient(rz, product(a, p, &q));
    report.residual = worst(advance(step, p, q, x, &r), bb);
  }
  return report;
}

}  // namespace gradus
