#include "reconstruct/multigrid.h"

#include <algorithm>

#include "reconstruct/rows.h"

namespace gradus {
namespace {

// The coarsest grid is small enough that these sweeps of Jacobi solve it well enough; a polynomial of A, so the cycle stays symmetric.
constexpr int kCoarsestSide = 2;
constexpr int kCoarsestSweeps = 8;

void smooth_from_zero(const WeightedSystem& a, const Field& b, Field* x) {
  for_rows(a.height(), [&](int y) {
    const float* s = a.smoothing.row(y);
    for (int c = 0; c < b.channels(); ++c) {
      const float* from = b.row(y, c);
      float* to = x->row(y, c);
      for (int i = 0; i < a.width(); ++i) to[i] = s[i] * from[i];
    }
  });
}

// to = x + damping/diagonal (b - A x)
void smooth(const WeightedSystem& a, const Field& b, const Field& x, Field* to) {
  for_rows(a.height(), [&](int y) {
    const float* s = a.smoothing.row(y);
    for (int c = 0; c < b.channels(); ++c) {
      float* out = to->row(y, c);
      apply_row(a, x, y, c, out);
      const float* right_side = b.row(y, c);
      const float* here = x.row(y, c);
      for (int i = 0; i < a.width(); ++i) out[i] = here[i] + s[i] * (right_side[i] - out[i]);
    }
  });
}

// coarse = sum over 2×2 of b - A x: the transpose of constant interpolation.
void restrict_residual(const WeightedSystem& a, const Field& b, const Field& x, Field* coarse) {
  const int w = a.width(), h = a.height();
  for_rows(
      coarse->height(),
      [&](int y) {
        std::vector<float> residual(size_t(w) + 1), product(static_cast<size_t>(w));
        for (int c = 0; c < b.channels(); ++c) {
          std::fill(residual.begin(), residual.end(), 0.0f);
          for (int fy = 2 * y; fy < std::min(2 * y + 2, h); ++fy) {
            apply_row(a, x, fy, c, product.data());
            const float* right_side = b.row(fy, c);
            for (int i = 0; i < w; ++i) residual[i] += right_side[i] - product[i];
          }
          float* to = coarse->row(y, c);
          for (int i = 0; i < coarse->width(); ++i) to[i] = residual[2 * i] + residual[2 * i + 1];
        }
      },
      16);
}

void add_interpolated(const Field& coarse, Field* x) {
  for_rows(x->height(), [&](int y) {
    for (int c = 0; c < x->channels(); ++c) {
      const float* from = coarse.row(y / 2, c);
      float* to = x->row(y, c);
      for (int i = 0; i < x->width(); ++i) to[i] += from[i / 2];
    }
  });
}

}  // namespace

Multigrid::Multigrid(int width, int height, int channels) {
  for (;; width = (width + 1) / 2, height = (height + 1) / 2) {
    Level& level = levels_.emplace_back();
    level.system = WeightedSystem(width, height);
    level.x = Field(width, height, channels);
    if (levels_.size() > 1) level.b = level.z = level.x;
    if (std::max(width, height) <= kCoarsestSide) break;
  }
}

void Multigrid::update() {
  for (size_t i = 0; i + 1 < levels_.size(); ++i) coarsen(levels_[i].system, &levels_[i + 1].system);
}

void Multigrid::cycle(const Field& b, Field* z) { cycle(0, b, z); }

void Multigrid::cycle(size_t level, const Field& b, Field* z) {
  Level& here = levels_[level];
  smooth_from_zero(here.system, b, &here.x);
  if (level + 1 == levels_.size()) {
    for (int sweep = 0; sweep < kCoarsestSweeps; ++sweep) {
      smooth(here.system, b, here.x, z);
      std::swap(here.x, *z);
    }
    smooth(here.system, b, here.x, z);
    return;
  }
  Level& next = levels_[level + 1];
  restrict_residual(here.system, b, here.x, &next.b);
  cycle(level + 1, next.b, &next.z);
  add_interpolated(next.z, &here.x);
  smooth(here.system, b, here.x, z);
}

}  // namespace gradus
