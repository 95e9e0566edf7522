// One symmetric V-cycle as preconditioner: z ≈ A⁻¹ b. Damped Jacobi once before and once after, black-box interpolation.
#pragma once

#include <vector>

#include "reconstruct/interpolation.h"
#include "reconstruct/rows.h"

namespace gradus {

class Multigrid {
 public:
  Multigrid(int width, int height, int channels);
  // The finest matrix, to be filled; then update().
  Stencil& matrix() { return levels_.front().matrix; }
  const Stencil& matrix() const { return levels_.front().matrix; }
  // Makes the coarse matrices from the finest.
  void update();
  // Overwrites z and returns b·z of each row; b must have the grid's size and the multigrid's channels. Not for two threads at once: work
  // space is its own.
  RowSums cycle(const Field& b, Field* z) { return cycle(0, b, z); }

 private:
  struct Level {
    Stencil matrix;
    Interpolation interpolation;  // from the next one
    Field b, z;                   // of coarse levels
  };
  RowSums cycle(size_t level, const Field& b, Field* z);
  std::vector<Level> levels_;
};

}  // namespace gradus
