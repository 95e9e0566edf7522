// One symmetric V-cycle as preconditioner: z ≈ A⁻¹ b. Red-black Gauss-Seidel on the finest grid (red_black.h), damped
// Jacobi twice before and twice after on the coarse ones, black-box interpolation.
#pragma once

#include <memory>
#include <vector>

#include "base/rows.h"
#include "reconstruct/interpolation.h"

namespace gradus::reconstruct {

// Values on coarse grids while a cycle runs. Multigrids of one size may share it, one cycle at a time.
class MultigridWork {
 public:
  MultigridWork(int width, int height, int channels);

 private:
  friend class Multigrid;
  struct Level {
    Field b, z, swept;
  };
  std::vector<Level> levels_;  // the first is empty: its fields are the caller's
};

class Multigrid {
 public:
  Multigrid(int width, int height, int channels)
      : Multigrid(width, height, std::make_shared<MultigridWork>(width, height, channels)) {}
  Multigrid(int width, int height, std::shared_ptr<MultigridWork> work);
  // The finest matrix, to be filled; then update().
  Stencil& matrix() { return levels_.front().matrix; }
  const Stencil& matrix() const { return levels_.front().matrix; }
  // Makes the coarse matrices from the finest.
  void update();
  // Overwrites z and returns b·z of each row; b must have the grid's size and the multigrid's channels. Not for two
  // threads at once, nor for two multigrids that share their work space.
  RowSums cycle(const Field& b, Field* z);

 private:
  struct Level {
    Stencil matrix;
    Interpolation interpolation;  // from the next one
  };
  // What a coarse grid and those below make of its right side, → its z.
  const Field& solve_coarse(size_t level);
  std::vector<Level> levels_;
  std::shared_ptr<MultigridWork> work_;
};

}  // namespace gradus::reconstruct
