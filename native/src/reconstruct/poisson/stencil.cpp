#include "reconstruct/poisson/stencil.h"

#include "base/rows.h"

namespace gradus::reconstruct {
namespace {

// Damping of Jacobi. Of 0.6 to 0.9, this value needs the fewest steps for weights of rendered images (measured).
constexpr float kDamping = 0.8f;

}  // namespace

Stencil::Stencil(int width, int height, bool with_corners)
    : diagonal(width, height, 1), right(diagonal), up(diagonal), corners(with_corners) {
  if (corners) up_right = up_left = diagonal;
}

void read_smoothing(const Stencil& a, int y, float* out) {
  const float* d = a.diagonal.row(y);
  for (int x = 0; x < a.width(); ++x) out[x] = kDamping * inverse_or_zero(d[x]);
}

void apply_row(const Stencil& a, int y, const float* below, const float* here, const float* above, float* out) {
  const int w = a.width();
  const float *diagonal = a.diagonal.row(y), *right = a.right.row(y), *up = a.up.row(y), *down = a.up.row(y - 1);
  if (!a.corners) {
    for (int i = 0; i < w; ++i) {
      out[i] = diagonal[i] * here[i] - right[i] * here[i + 1] - right[i - 1] * here[i - 1] - up[i] * above[i] -
               down[i] * below[i];
    }
    return;
  }
  const float *up_right = a.up_right.row(y), *up_left = a.up_left.row(y), *down_left = a.up_right.row(y - 1),
              *down_right = a.up_left.row(y - 1);
  // There are more rows than compilers check for overlap; none of them is `out`.
#pragma GCC ivdep
  for (int i = 0; i < w; ++i) {
    out[i] = diagonal[i] * here[i] - right[i] * here[i + 1] - right[i - 1] * here[i - 1] - up[i] * above[i] -
             down[i] * below[i] - up_right[i] * above[i + 1] - up_left[i] * above[i - 1] -
             down_left[i - 1] * below[i - 1] - down_right[i + 1] * below[i + 1];
  }
}

}  // namespace gradus::reconstruct
