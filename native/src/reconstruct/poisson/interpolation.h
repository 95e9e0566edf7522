// Black-box multigrid's transfer between a grid and the grid of every second pixel (Dendy 1982, "Black box multigrid").
// The matrix itself defines the interpolation, so that a value spreads along strong couplings and not across weak ones.
#pragma once

#include <array>

#include "reconstruct/poisson/stencil.h"

namespace gradus::reconstruct {

// The interpolation P. Coarse pixel (X, Y) is fine pixel (2X, 2Y). For each coarse pixel, P stores the weights of the
// fine pixels to its right, above it, and diagonally between.
class Interpolation {
 public:
  Interpolation() = default;
  // Prepares the interpolation to a fine grid of this size.
  Interpolation(int width, int height);

  // Computes the weights from the fine matrix. A pixel takes the value that solves its own equation; on an edge of the
  // coarse grid, couplings across the edge count as if the value did not change across it.
  void update(const Stencil& fine);
  // Computes coarse = Pᵀ A P.
  void coarsen(const Stencil& fine, Stencil* coarse) const;

  // Writes fine row y of P x, from the coarse rows y / 2 (`lower`) and y / 2 + 1 (`upper`). Writes an even number of
  // values.
  void interpolate_row(int y, const float* lower, const float* upper, float* out) const;
  // Writes coarse row y of Pᵀ r, from the fine rows 2y - 1, 2y and 2y + 1 of r.
  void restrict_rows(int y, const float* below, const float* here, const float* above, float* out) const;

  // Adds fine row y of P x to a row that has only the pixels with even x + y, next to each other in memory.
  void add_to_red_row(int y, const float* lower, const float* upper, float* red) const;
  // Writes coarse row y of Pᵀ r from rows that have only the pixels with even x + y. All other residuals must be 0.
  void restrict_red_rows(int y, const float* below, const float* here, const float* above, float* out) const;
  // Frees the weights of the other pixels. Afterwards only add_to_red_row() and restrict_red_rows() may be called.
  void keep_red();

 private:
  // Columns of P: weights of coarse row y, from pixel x on, for the 3×3 fine pixels around each. Weights of row y - 1
  // for y = 0 lie in the rim of the fields and are 0, as are all others beyond the border.
  struct Columns {
    const float* at[3][3];
  };
  Columns columns(int x, int y) const;
  // Performs coarsen() for coarse pixels [x, x + count) of row y.
  void coarsen_block(const Stencil& fine, int x, int y, int count, Stencil* coarse) const;

  Field from_left_, from_right_;                // weights of fine pixel (2X + 1, 2Y)
  Field from_below_, from_above_;               // weights of fine pixel (2X, 2Y + 1)
  std::array<std::array<Field, 2>, 2> corner_;  // weights of (2X + 1, 2Y + 1): [above][right]
};

}  // namespace gradus::reconstruct
