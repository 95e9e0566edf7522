// Black-box multigrid's way from a grid to the one of every second pixel and back (Dendy 1982, "Black box multigrid"):
// interpolation by the matrix itself, so that a value spreads along strong couplings and not across weak ones.
#pragma once

#include <array>

#include "reconstruct/stencil.h"

namespace gradus::reconstruct {

// Coarse pixel (X, Y) is fine pixel (2X, 2Y). Weights of the fine pixels to its right, above it and diagonally between,
// by coarse pixel.
class Interpolation {
 public:
  Interpolation() = default;
  // For a fine grid of this size.
  Interpolation(int width, int height);

  // Weights from the fine matrix: a pixel takes the value that solves its own equation, where along an edge of the
  // coarse grid the couplings across the edge are counted as if the value did not change across it.
  void update(const Stencil& fine);
  // coarse = Pᵀ A P
  void coarsen(const Stencil& fine, Stencil* coarse) const;

  // Fine row y of P x, from the coarse rows y / 2 and the one above it. Writes an even number of values.
  void interpolate_row(int y, const float* lower, const float* upper, float* out) const;
  // Coarse row y of Pᵀ r, from the fine rows 2y - 1, 2y, 2y + 1.
  void restrict_rows(int y, const float* below, const float* here, const float* above, float* out) const;

  // The same for pixels with x + y even, of which there are every second in a row, side by side. Adds to them.
  void add_to_red_row(int y, const float* lower, const float* upper, float* red) const;
  // Of residuals that are 0 elsewhere.
  void restrict_red_rows(int y, const float* below, const float* here, const float* above, float* out) const;
  // Gives the rest back: from here on, red pixels are all that is asked for.
  void keep_red();

 private:
  // Weights of coarse row y, from pixel x on, for the 3×3 fine pixels around each: columns of P. Row y - 1 of them is
  // beyond the border for y = 0 and 0 there, as all beyond it is.
  struct Columns {
    const float* at[3][3];
  };
  Columns columns(int x, int y) const;
  // coarsen() for coarse pixels [x, x + count) of row y
  void coarsen_block(const Stencil& fine, int x, int y, int count, Stencil* coarse) const;

  Field from_left_, from_right_;                // of (2X + 1, 2Y)
  Field from_below_, from_above_;               // of (2X, 2Y + 1)
  std::array<std::array<Field, 2>, 2> corner_;  // of (2X + 1, 2Y + 1): [above][right]
};

}  // namespace gradus::reconstruct
