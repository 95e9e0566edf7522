#include "reconstruct/poisson/interpolation.h"

#include <algorithm>
#include <array>

#include "base/rows.h"

namespace gradus::reconstruct {
namespace {

float quotient(float a, float b) { return a * inverse_or_zero(b); }

// Number of coarse pixels that coarsen() handles at a time.
constexpr int kBlock = 64;
// Weights of coarse pixels in their own fine pixels.
constexpr auto kOnes = [] {
  std::array<float, kBlock> ones{};
  ones.fill(1.0f);
  return ones;
}();

// Couplings of the pixels of one fine row with their neighbours. Diagonal couplings are 0 in a matrix without them.
struct Row {
  Row(const Stencil& a, int y)
      : diagonal(a.diagonal.row(y)), right(a.right.row(y)), up(a.up.row(y)), down(a.up.row(y - 1)), corners(a.corners) {
    if (!corners) return;
    up_right = a.up_right.row(y);
    up_left = a.up_left.row(y);
    down_left = a.up_right.row(y - 1) - 1;
    down_right = a.up_left.row(y - 1) + 1;
  }
  float to_left(int x) const { return right[x - 1] + (corners ? up_left[x] + down_left[x] : 0.0f); }
  float to_right(int x) const { return right[x] + (corners ? up_right[x] + down_right[x] : 0.0f); }
  float to_below(int x) const { return down[x] + (corners ? down_left[x] + down_right[x] : 0.0f); }
  float to_above(int x) const { return up[x] + (corners ? up_left[x] + up_right[x] : 0.0f); }
  static float at(const float* entries, int x) { return entries ? entries[x] : 0.0f; }

  const float *diagonal, *right, *up, *down;
  const float *up_right = nullptr, *up_left = nullptr, *down_left = nullptr, *down_right = nullptr;
  bool corners;
};

}  // namespace

Interpolation::Interpolation(int width, int height) : corner_{{{Field((width + 1) / 2, (height + 1) / 2, 1)}}} {
  corner_[0][1] = corner_[1][0] = corner_[1][1] = corner_[0][0];
}

void Interpolation::update(const Stencil& fine) {
  const int w = fine.width(), h = fine.height();
  if (from_left_.width() == 0) {
    for (Field* edges : {&from_left_, &from_right_, &from_below_, &from_above_})
      *edges = Field((w + 1) / 2, (h + 1) / 2, 1);
  }
  for_rows((h + 1) / 2, [&](int y) {
    const Row even(fine, 2 * y);
    float *left = from_left_.row(y), *right = from_right_.row(y);
    for (int x = 1; x < w; x += 2) {
      const float remaining = even.diagonal[x] - even.up[x] - even.down[x];
      left[x / 2] = quotient(even.to_left(x), remaining);
      right[x / 2] = quotient(even.to_right(x), remaining);
    }
    if (2 * y + 1 == h) return;
    const Row odd(fine, 2 * y + 1);
    float *below = from_below_.row(y), *above = from_above_.row(y);
    for (int x = 0; x < w; x += 2) {
      const float remaining = odd.diagonal[x] - odd.right[x] - odd.right[x - 1];
      below[x / 2] = quotient(odd.to_below(x), remaining);
      above[x / 2] = quotient(odd.to_above(x), remaining);
    }
  });
  for_rows(h / 2, [&](int y) {
    const Row odd(fine, 2 * y + 1);
    const float *below = from_below_.row(y), *above = from_above_.row(y);
    for (int i = 0; i < w / 2; ++i) {
      const int x = 2 * i + 1;
      const float west = odd.right[x - 1], east = odd.right[x], south = odd.down[x], north = odd.up[x],
                  all = odd.diagonal[x];
      corner_[0][0].row(y)[i] =
          quotient(Row::at(odd.down_left, x) + west * below[i] + south * from_left_.row(y)[i], all);
      corner_[0][1].row(y)[i] =
          quotient(Row::at(odd.down_right, x) + east * below[i + 1] + south * from_right_.row(y)[i], all);
      corner_[1][0].row(y)[i] =
          quotient(Row::at(odd.up_left, x) + west * above[i] + north * from_left_.row(y + 1)[i], all);
      corner_[1][1].row(y)[i] =
          quotient(Row::at(odd.up_right, x) + east * above[i + 1] + north * from_right_.row(y + 1)[i], all);
    }
  });
}

Interpolation::Columns Interpolation::columns(int x, int y) const {
  return {{{corner_[1][1].row(y - 1) + x - 1, from_above_.row(y - 1) + x, corner_[1][0].row(y - 1) + x},
           {from_right_.row(y) + x - 1, kOnes.data(), from_left_.row(y) + x},
           {corner_[0][1].row(y) + x - 1, from_below_.row(y) + x, corner_[0][0].row(y) + x}}};
}

void Interpolation::coarsen_block(const Stencil& fine, int x, int y, int count, Stencil* coarse) const {
  // Product of A with columns of P, on the 5×5 fine pixels around each coarse pixel.
  float product[5][5][kBlock] = {};
  const Columns own = columns(x, y);
  for (int j = 0; j < 3; ++j) {
    const int fine_y = 2 * y + j - 1;
    if (fine_y < 0 || fine_y >= fine.height()) continue;
    const Row row(fine, fine_y);
    for (int i = 0; i < 3; ++i) {
      const float* p = own.at[j][i];
      const ptrdiff_t first = 2 * ptrdiff_t(x) + i - 1;
      const auto add = [&](int dx, int dy, float sign, const float* entries) {
        float* to = product[j + 1 + dy][i + 1 + dx];
        for (ptrdiff_t k = 0; k < count; ++k) to[k] += sign * entries[first + 2 * k] * p[k];
      };
      add(0, 0, 1.0f, row.diagonal);
      add(1, 0, -1.0f, row.right);
      add(-1, 0, -1.0f, row.right - 1);
      add(0, 1, -1.0f, row.up);
      add(0, -1, -1.0f, row.down);
      if (!fine.corners) continue;
      add(1, 1, -1.0f, row.up_right);
      add(-1, 1, -1.0f, row.up_left);
      add(-1, -1, -1.0f, row.down_left);
      add(1, -1, -1.0f, row.down_right);
    }
  }
  // Writes the product of these with the columns of the coarse pixels at x + dx, y + dy.
  const auto fill = [&](int dx, int dy, float sign, float* out) {
    const Columns other = columns(x + dx, y + dy);
    float sums[kBlock] = {};
    for (int j = std::max(0, -2 * dy - 1); j < std::min(3, 4 - 2 * dy); ++j) {
      for (int i = std::max(0, -2 * dx - 1); i < std::min(3, 4 - 2 * dx); ++i) {
        const float *a = product[j + 1 + 2 * dy][i + 1 + 2 * dx], *p = other.at[j][i];
        for (int k = 0; k < count; ++k) sums[k] += a[k] * p[k];
      }
    }
    for (int k = 0; k < count; ++k) out[k] = sign * sums[k];
  };
  fill(0, 0, 1.0f, coarse->diagonal.row(y) + x);
  fill(1, 0, -1.0f, coarse->right.row(y) + x);
  if (y + 1 == coarse->height()) return;
  fill(0, 1, -1.0f, coarse->up.row(y) + x);
  fill(1, 1, -1.0f, coarse->up_right.row(y) + x);
  fill(-1, 1, -1.0f, coarse->up_left.row(y) + x);
}

void Interpolation::coarsen(const Stencil& fine, Stencil* coarse) const {
  const int w = coarse->width();
  for_rows(coarse->height(), [&](int y) {
    for (int x = 0; x < w; x += kBlock) coarsen_block(fine, x, y, std::min(kBlock, w - x), coarse);
  });
}

void Interpolation::interpolate_row(int y, const float* lower, const float* upper, float* out) const {
  const ptrdiff_t w = from_left_.width();
  if (y % 2 == 0) {
    const float *left = from_left_.row(y / 2), *right = from_right_.row(y / 2);
    for (ptrdiff_t x = 0; x < w; ++x) {
      out[2 * x] = lower[x];
      out[2 * x + 1] = left[x] * lower[x] + right[x] * lower[x + 1];
    }
    return;
  }
  const float *below = from_below_.row(y / 2), *above = from_above_.row(y / 2);
  const float *c00 = corner_[0][0].row(y / 2), *c01 = corner_[0][1].row(y / 2), *c10 = corner_[1][0].row(y / 2),
              *c11 = corner_[1][1].row(y / 2);
  for (ptrdiff_t x = 0; x < w; ++x) {
    out[2 * x] = below[x] * lower[x] + above[x] * upper[x];
    out[2 * x + 1] = c00[x] * lower[x] + c01[x] * lower[x + 1] + c10[x] * upper[x] + c11[x] * upper[x + 1];
  }
}

void Interpolation::restrict_rows(int y, const float* below, const float* here, const float* above, float* out) const {
  const ptrdiff_t w = from_left_.width();
  const float *left = from_left_.row(y), *right = from_right_.row(y), *up = from_below_.row(y),
              *down = from_above_.row(y - 1);
  const float *c00 = corner_[0][0].row(y), *c01 = corner_[0][1].row(y), *c10 = corner_[1][0].row(y - 1),
              *c11 = corner_[1][1].row(y - 1);
#pragma GCC ivdep
  for (ptrdiff_t x = 0; x < w; ++x) {
    out[x] = here[2 * x] + left[x] * here[2 * x + 1] + right[x - 1] * here[2 * x - 1]            //
             + up[x] * above[2 * x] + c00[x] * above[2 * x + 1] + c01[x - 1] * above[2 * x - 1]  //
             + down[x] * below[2 * x] + c10[x] * below[2 * x + 1] + c11[x - 1] * below[2 * x - 1];
  }
}

void Interpolation::add_to_red_row(int y, const float* lower, const float* upper, float* red) const {
  const ptrdiff_t w = corner_[0][0].width();
  if (y % 2 == 0) {
    for (ptrdiff_t x = 0; x < w; ++x) red[x] += lower[x];
    return;
  }
  const float *c00 = corner_[0][0].row(y / 2), *c01 = corner_[0][1].row(y / 2), *c10 = corner_[1][0].row(y / 2),
              *c11 = corner_[1][1].row(y / 2);
  for (ptrdiff_t x = 0; x < w; ++x)
    red[x] += c00[x] * lower[x] + c01[x] * lower[x + 1] + c10[x] * upper[x] + c11[x] * upper[x + 1];
}

void Interpolation::restrict_red_rows(int y, const float* below, const float* here, const float* above,
                                      float* out) const {
  const ptrdiff_t w = corner_[0][0].width();
  const float *c00 = corner_[0][0].row(y), *c01 = corner_[0][1].row(y), *c10 = corner_[1][0].row(y - 1),
              *c11 = corner_[1][1].row(y - 1);
  for (ptrdiff_t x = 0; x < w; ++x) {
    out[x] = here[x] + c00[x] * above[x] + c01[x - 1] * above[x - 1] + c10[x] * below[x] + c11[x - 1] * below[x - 1];
  }
}

void Interpolation::keep_red() {
  for (Field* edges : {&from_left_, &from_right_, &from_below_, &from_above_}) *edges = Field();
}

}  // namespace gradus::reconstruct
