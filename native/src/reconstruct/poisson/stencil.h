// A symmetric matrix on a grid that couples each pixel with at most eight neighbours.
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

// Returns 1/d, or 0 if d is not positive, as for a pixel without any row of weight above 0. Without a branch, so that
// loops can be vectorised.
inline float inverse_or_zero(float d) {
  constexpr float kMin = std::numeric_limits<float>::min();
  return std::clamp(d / kMin, 0.0f, 1.0f) / std::max(d, kMin);
}

// Writes the factors of damped Jacobi for row y: damping / diagonal.
void read_smoothing(const Stencil& a, int y, float* out);
// Computes out = A x for row y of one channel, from that row of x and the rows below and above it. `out` must not
// overlap them.
void apply_row(const Stencil& a, int y, const float* below, const float* here, const float* above, float* out);
inline void apply_row(const Stencil& a, const Field& x, int y, int channel, float* out) {
  apply_row(a, y, x.row(y - 1, channel), x.row(y, channel), x.row(y + 1, channel), out);
}

}  // namespace gradus::reconstruct
