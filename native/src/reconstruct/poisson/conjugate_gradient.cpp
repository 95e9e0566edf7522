#include "reconstruct/poisson/conjugate_gradient.h"

#include "reconstruct/poisson/cg_loop.h"

namespace gradus::reconstruct {
namespace {

constexpr float kDivergence = 3.0f;

Sums dot(const Field& a, const Field& b) {
  return sum_rows(a.height(), a.channels(), [&](int y, int c) { return dot_row(a.row(y, c), b.row(y, c), a.width()); });
}

// Computes r = b - A x and returns r·r.
Sums residual(const Stencil& a, const Field& b, const Field& x, Field* r) {
  return sum_rows(a.height(), b.channels(), [&](int y, int c) {
    float* to = r->row(y, c);
    apply_row(a, x, y, c, to);
    const float* from = b.row(y, c);
    for (int i = 0; i < a.width(); ++i) to[i] = from[i] - to[i];
    return dot_row(to, to, a.width());
  });
}

// Computes the next direction, p = z + factor before, and returns p·Ap.
Sums direct(const Stencil& a, const Field& z, const Sums& factor, const Field& before, Field* p) {
  const int w = a.width(), channels = z.channels();
  const auto add = [&](int y, int c, float* to) {
    const auto f = static_cast<float>(factor[c]);
    const float *from = z.row(y, c), *old = before.row(y, c);  // 0 beyond the border
    for (int i = 0; i < w; ++i) to[i] = from[i] + f * old[i];
  };
  RowSums sums(a.height(), channels);
  for_pieces(
      a.height(),
      [&](int begin, int end) {
        // Other threads write the rows of p around the piece, so this piece computes its own copies.
        RollingRows outer(w, channels);
        std::vector<float> product(static_cast<size_t>(w));
        for (int c = 0; c < channels; ++c) {
          add(begin - 1, c, outer.row(0, c));
          add(end, c, outer.row(1, c));
          add(begin, c, p->row(begin, c));
        }
        for (int y = begin; y < end; ++y) {
          for (int c = 0; c < channels; ++c) {
            const bool last = y + 1 == end;
            if (!last) add(y + 1, c, p->row(y + 1, c));
            const float *here = p->row(y, c), *below = y == begin ? outer.row(0, c) : p->row(y - 1, c);
            apply_row(a, y, below, here, last ? outer.row(1, c) : p->row(y + 1, c), product.data());
            sums.at(y, c) = dot_row(here, product.data(), w);
          }
        }
      },
      kGrainOfStencils);
  return sums.total();
}

// Computes x += step p and r -= step A p, and returns r·r. A p is computed again, which takes less time than to store
// and load it.
Sums advance(const Stencil& a, const Sums& step, const Field& p, Field* x, Field* r) {
  const int w = a.width(), channels = p.channels();
  RowSums sums(a.height(), channels);
  for_pieces(a.height(), [&](int begin, int end) {
    std::vector<float> product(static_cast<size_t>(w));
    for (int y = begin; y < end; ++y) {
      for (int c = 0; c < channels; ++c) {
        apply_row(a, p, y, c, product.data());
        const auto s = static_cast<float>(step[c]);
        float *to_x = x->row(y, c), *to_r = r->row(y, c);
        const float* from = p.row(y, c);
        for (int i = 0; i < w; ++i) {
          to_x[i] += s * from[i];
          to_r[i] -= s * product[i];
        }
        sums.at(y, c) = dot_row(to_r, to_r, w);
      }
    }
  });
  return sums.total();
}

// The vector operations of run_conjugate_gradient() for one image.
struct Steps {
  int width() const { return a.width(); }
  CgStart start() { return {dot(b, b), residual(a, b, *x, &fields.r)}; }
  CgProducts precondition() {
    const RowSums rows = preconditioner->cycle(fields.r, &fields.z);
    return {rows.total(), rows.largest()};
  }
  Sums direct(const Sums& factor) {
    const Sums pap = reconstruct::direct(a, fields.z, factor, fields.p, &fields.next_p);
    std::swap(fields.p, fields.next_p);
    return pap;
  }
  Sums advance(const Sums& step) { return reconstruct::advance(a, step, fields.p, x, &fields.r); }

  Multigrid* preconditioner;
  const Stencil& a;
  const Field& b;
  Field* x;
  CgFields& fields;
};

}  // namespace

CgReport conjugate_gradient(Multigrid* preconditioner, const Field& b, Field* x, CgFields* fields, const CgGoal& goal,
                            int max_steps, const CancelCheck& cancel) {
  return run_conjugate_gradient(Steps{preconditioner, preconditioner->matrix(), b, x, *fields}, goal, kDivergence,
                                max_steps, cancel);
}

}  // namespace gradus::reconstruct
