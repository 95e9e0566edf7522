// A symmetric matrix on a grid that couples each pixel with its eight neighbours at most.
#pragma once

#include <algorithm>
#include <limits>

#include "reconstruct/field.h"

namespace gradus::reconstruct {

struct Stencil {
  Stencil() = default;
  Stencil(int width, int height, bool corners);
  int width() const { return diagonal.width(); }
  int height() const { return diagonal.height(); }

  Field diagonal;
  Field right, up;          // minus the entries for x + 1 and y + 1; 0 in the last column and row
  Field up_right, up_left;  // minus those for (x + 1, y + 1) and (x - 1, y + 1); empty without corners
  bool corners = false;
};

// 1/d; 0 where d is not positive, as of a pixel that nothing holds. Without a branch, so that loops of it take vectors.
inline float inverse_or_zero(float d) {
  constexpr float kMin = std::numeric_limits<float>::min();
  return std::clamp(d / kMin, 0.0f, 1.0f) / std::max(d, kMin);
}

// Damped Jacobi of row y: damping / diagonal.
void read_smoothing(const Stencil& a, int y, float* out);
// out = A x for row y of one channel, from that row of x and the rows below and above it.
void apply_row(const Stencil& a, int y, const float* below, const float* here, const float* above, float* out);
inline void apply_row(const Stencil& a, const Field& x, int y, int channel, float* out) {
  apply_row(a, y, x.row(y - 1, channel), x.row(y, channel), x.row(y + 1, channel), out);
}

}  // namespace gradus::reconstruct
