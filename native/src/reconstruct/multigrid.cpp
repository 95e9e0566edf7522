#include "reconstruct/multigrid.h"

#include <algorithm>

namespace gradus {
namespace {

// The coarsest grid is small enough that these sweeps of Jacobi solve it well enough; a polynomial of A, so the cycle stays symmetric.
constexpr int kCoarsestSide = 2;
constexpr int kCoarsestSweeps = 8;
// Rows at a time: the passes below make some rows around each piece once more.
constexpr int kGrain = 64;

// x = S b: what one sweep makes of 0. Rows beyond the grid are 0. s: scratch.
void smooth_zero(const Stencil& a, const Field& b, int y, float* s, RollingRows* x) {
  if (y >= 0 && y < a.height()) read_smoothing(a, y, s);
  for (int c = 0; c < b.channels(); ++c) {
    float* to = x->row(y, c);
    if (y < 0 || y >= a.height()) {
      std::fill_n(to, a.width(), 0.0f);
      continue;
    }
    const float* from = b.row(y, c);
    for (int i = 0; i < a.width(); ++i) to[i] = s[i] * from[i];
  }
}

// b - A x of a row
void subtract_product(const Stencil& a, const Field& b, int y, int c, RollingRows* x, float* out) {
  apply_row(a, y, x->row(y - 1, c), x->row(y, c), x->row(y + 1, c), out);
  const float* from = b.row(y, c);
  for (int i = 0; i < a.width(); ++i) out[i] = from[i] - out[i];
}

// coarse = Pᵀ(b - A S b)
void restrict_residual(const Stencil& a, const Interpolation& p, const Field& b, Field* coarse) {
  for_pieces(
      coarse->height(),
      [&](int begin, int end) {
        RollingRows x(a.width(), b.channels()), residual(a.width(), b.channels());
        std::vector<float> s(static_cast<size_t>(a.width()));
        const auto add_row = [&](int y) {
          smooth_zero(a, b, y + 1, s.data(), &x);
          for (int c = 0; c < b.channels(); ++c) {
            float* to = residual.row(y, c);
            if (y < 0 || y >= a.height()) {
              std::fill_n(to, a.width(), 0.0f);
            } else {
              subtract_product(a, b, y, c, &x, to);
            }
          }
        };
        smooth_zero(a, b, 2 * begin - 2, s.data(), &x);
        smooth_zero(a, b, 2 * begin - 1, s.data(), &x);
        add_row(2 * begin - 1);
        for (int y = begin; y < end; ++y) {
          add_row(2 * y);
          add_row(2 * y + 1);
          for (int c = 0; c < b.channels(); ++c) {
            p.restrict_rows(y, residual.row(2 * y - 1, c), residual.row(2 * y, c), residual.row(2 * y + 1, c), coarse->row(y, c));
          }
        }
      },
      kGrain / 2);
}

// Makes the rows of x + S(b - A x) with x = S b + P coarse: take(y, channel, row).
template <class Take>
void interpolate_and_smooth(const Stencil& a, const Interpolation& p, const Field& b, const Field& coarse, const Take& take) {
  const int w = a.width();
  for_pieces(
      a.height(),
      [&](int begin, int end) {
        RollingRows x(w, b.channels());
        std::vector<float> correction(size_t(w) + 1), s(static_cast<size_t>(w)), row(s);
        const auto add_row = [&](int y) {
          smooth_zero(a, b, y, s.data(), &x);
          if (y < 0 || y >= a.height()) return;
          for (int c = 0; c < b.channels(); ++c) {
            p.interpolate_row(y, coarse.row(y / 2, c), coarse.row(y / 2 + 1, c), correction.data());
            float* to = x.row(y, c);
            for (int i = 0; i < w; ++i) to[i] += correction[i];
          }
        };
        add_row(begin - 1);
        add_row(begin);
        for (int y = begin; y < end; ++y) {
          add_row(y + 1);
          read_smoothing(a, y, s.data());
          for (int c = 0; c < b.channels(); ++c) {
            subtract_product(a, b, y, c, &x, row.data());
            const float* here = x.row(y, c);
            for (int i = 0; i < w; ++i) row[size_t(i)] = here[i] + s[size_t(i)] * row[size_t(i)];
            take(y, c, row.data());
          }
        }
      },
      kGrain);
}

// Sweeps of Jacobi from 0.
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
  return sum_each_row(a.height(), b.channels(), [&](int y, int c) { return dot_row(z->row(y, c), b.row(y, c), a.width()); });
}

}  // namespace

MultigridWork::MultigridWork(int width, int height, int channels) {
  levels_.emplace_back();
  while (std::max(width, height) > kCoarsestSide) {
    width = (width + 1) / 2, height = (height + 1) / 2;
    levels_.push_back({Field(width, height, channels), Field(width, height, channels)});
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
}

const Field& Multigrid::coarse_solution(size_t level, const Field& b) {
  MultigridWork::Level& next = work_->levels_[level + 1];
  restrict_residual(levels_[level].matrix, levels_[level].interpolation, b, &next.b);
  cycle(level + 1, next.b, &next.z);
  return next.z;
}

RowSums Multigrid::cycle(size_t level, const Field& b, Field* z) {
  const Level& here = levels_[level];
  if (level + 1 == levels_.size()) return solve_coarsest(here.matrix, b, z);
  RowSums sums(b.height(), b.channels());
  interpolate_and_smooth(here.matrix, here.interpolation, b, coarse_solution(level, b), [&](int y, int c, const float* row) {
    std::copy_n(row, b.width(), z->row(y, c));
    sums.at(y, c) = dot_row(row, b.row(y, c), b.width());
  });
  return sums;
}

void Multigrid::add_cycle(const Field& b, Field* z) {
  const Level& here = levels_.front();
  const auto add = [&](int y, int c, const float* row) {
    float* to = z->row(y, c);
    for (int i = 0; i < b.width(); ++i) to[i] += row[i];
  };
  if (levels_.size() > 1) return interpolate_and_smooth(here.matrix, here.interpolation, b, coarse_solution(0, b), add);
  Field more(b.width(), b.height(), b.channels());
  solve_coarsest(here.matrix, b, &more);
  for (int c = 0; c < b.channels(); ++c) {
    for (int y = 0; y < b.height(); ++y) add(y, c, more.row(y, c));
  }
}

}  // namespace gradus
