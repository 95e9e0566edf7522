#include "reconstruct/poisson/multigrid.h"

#include <algorithm>

#include "reconstruct/poisson/red_black.h"

namespace gradus::reconstruct {
namespace {

// The coarsest grid is so small that this number of Jacobi sweeps solves it well enough. They are a polynomial of A, so
// the cycle remains symmetric.
constexpr int kCoarsestSide = 2;
constexpr int kCoarsestSweeps = 8;

// Computes to = x + S(b - A x). make(y, scratch, &rows) makes row y of x; `scratch` has one float more than a row.
template <class Make>
void sweep(const Stencil& a, const Field& b, const Make& make, Field* to) {
  const int w = a.width(), h = a.height(), channels = b.channels();
  for_pieces(
      h,
      [&](int begin, int end) {
        RollingRows x(w, channels);
        std::vector<float> scratch(size_t(w) + 1);
        const auto make_or_clear = [&](int y) {
          if (y >= 0 && y < h) return make(y, scratch.data(), &x);
          for (int c = 0; c < channels; ++c) std::fill_n(x.row(y, c), w, 0.0f);
        };
        make_or_clear(begin - 1);
        make_or_clear(begin);
        for (int y = begin; y < end; ++y) {
          make_or_clear(y + 1);
          read_smoothing(a, y, scratch.data());
          for (int c = 0; c < channels; ++c) {
            const float *s = scratch.data(), *from = b.row(y, c), *here = x.row(y, c);
            float* out = to->row(y, c);
            apply_row(a, y, x.row(y - 1, c), here, x.row(y + 1, c), out);
            for (int i = 0; i < w; ++i) out[i] = here[i] + s[i] * (from[i] - out[i]);
          }
        }
      },
      kGrainOfStencils);
}

// Writes the result of two Jacobi sweeps from 0.
void sweep_twice(const Stencil& a, const Field& b, Field* to) {
  const auto sweep_zero = [&](int y, float* s, RollingRows* x) {
    read_smoothing(a, y, s);
    for (int c = 0; c < b.channels(); ++c) {
      const float* from = b.row(y, c);
      float* out = x->row(y, c);
      for (int i = 0; i < a.width(); ++i) out[i] = s[i] * from[i];
    }
  };
  sweep(a, b, sweep_zero, to);
}

// Writes the result of two Jacobi sweeps from x + P coarse to `x`. Overwrites `to`.
void sweep_interpolated_twice(const Stencil& a, const Interpolation& p, const Field& b, const Field& coarse, Field* x,
                              Field* to) {
  const auto interpolate = [&](int y, float* more, RollingRows* rows) {
    for (int c = 0; c < b.channels(); ++c) {
      p.interpolate_row(y, coarse.row(y / 2, c), coarse.row(y / 2 + 1, c), more);
      const float* from = x->row(y, c);
      float* out = rows->row(y, c);
      for (int i = 0; i < a.width(); ++i) out[i] = from[i] + more[i];
    }
  };
  const auto copy = [&](int y, float* /*scratch*/, RollingRows* rows) {
    for (int c = 0; c < b.channels(); ++c) std::copy_n(to->row(y, c), a.width(), rows->row(y, c));
  };
  sweep(a, b, interpolate, to);
  sweep(a, b, copy, x);
  std::swap(*x, *to);
}

// Computes coarse = Pᵀ(b - A x).
void restrict_residual(const Stencil& a, const Interpolation& p, const Field& b, const Field& x, Field* coarse) {
  for_pieces(
      coarse->height(),
      [&](int begin, int end) {
        RollingRows residual(a.width(), b.channels());
        const auto make = [&](int y) {
          for (int c = 0; c < b.channels(); ++c) {
            float* to = residual.row(y, c);
            if (y < 0 || y >= a.height()) {
              std::fill_n(to, a.width(), 0.0f);
              continue;
            }
            apply_row(a, x, y, c, to);
            const float* from = b.row(y, c);
            for (int i = 0; i < a.width(); ++i) to[i] = from[i] - to[i];
          }
        };
        make(2 * begin - 1);
        for (int y = begin; y < end; ++y) {
          make(2 * y);
          make(2 * y + 1);
          for (int c = 0; c < b.channels(); ++c) {
            p.restrict_rows(y, residual.row(2 * y - 1, c), residual.row(2 * y, c), residual.row(2 * y + 1, c),
                            coarse->row(y, c));
          }
        }
      },
      kGrainOfStencils / 2);
}

// Solves the coarsest grid by Jacobi sweeps from 0 and returns b·z of each row.
RowSums solve_coarsest(const Stencil& a, const Field& b, Field* z) {
  Field x(a.width(), a.height(), b.channels());
  std::vector<float> s(static_cast<size_t>(a.width()));
  for (int sweep = 0; sweep < kCoarsestSweeps; ++sweep) {
    for (int y = 0; y < a.height(); ++y) {
      read_smoothing(a, y, s.data());
      for (int c = 0; c < b.channels(); ++c) {
        float* to = z->row(y, c);
        apply_row(a, x, y, c, to);
        for (int i = 0; i < a.width(); ++i) to[i] = x.row(y, c)[i] + s[i] * (b.row(y, c)[i] - to[i]);
      }
    }
    x = *z;
  }
  return sum_each_row(a.height(), b.channels(),
                      [&](int y, int c) { return dot_row(z->row(y, c), b.row(y, c), a.width()); });
}

}  // namespace

MultigridWork::MultigridWork(int width, int height, int channels) {
  levels_.emplace_back();
  while (std::max(width, height) > kCoarsestSide) {
    width = (width + 1) / 2, height = (height + 1) / 2;
    Level& level = levels_.emplace_back();
    level.b = level.z = level.swept = Field(width, height, channels);
  }
}

Multigrid::Multigrid(int width, int height, std::shared_ptr<MultigridWork> work) : work_(std::move(work)) {
  for (;; width = (width + 1) / 2, height = (height + 1) / 2) {
    Level& level = levels_.emplace_back();
    level.matrix = Stencil(width, height, levels_.size() > 1);
    if (std::max(width, height) <= kCoarsestSide) break;
    level.interpolation = Interpolation(width, height);
  }
}

void Multigrid::update() {
  for (size_t i = 0; i + 1 < levels_.size(); ++i) {
    levels_[i].interpolation.update(levels_[i].matrix);
    levels_[i].interpolation.coarsen(levels_[i].matrix, &levels_[i + 1].matrix);
  }
  levels_.front().interpolation.keep_red();
}

const Field& Multigrid::solve_coarse(size_t level) {
  const Level& here = levels_[level];
  MultigridWork::Level& work = work_->levels_[level];
  if (level + 1 == levels_.size()) {
    solve_coarsest(here.matrix, work.b, &work.z);
    return work.z;
  }
  sweep_twice(here.matrix, work.b, &work.swept);
  restrict_residual(here.matrix, here.interpolation, work.b, work.swept, &work_->levels_[level + 1].b);
  sweep_interpolated_twice(here.matrix, here.interpolation, work.b, solve_coarse(level + 1), &work.swept, &work.z);
  return work.z;
}

RowSums Multigrid::cycle(const Field& b, Field* z) {
  const Level& here = levels_.front();
  if (levels_.size() == 1) return solve_coarsest(here.matrix, b, z);
  restrict_after_sweep(here.matrix, here.interpolation, b, &work_->levels_[1].b);
  return sweep_interpolated(here.matrix, here.interpolation, b, solve_coarse(1), z);
}

}  // namespace gradus::reconstruct
