// One symmetric V-cycle of multigrid as a preconditioner, z ≈ A⁻¹ b. It uses red-black Gauss-Seidel on the finest grid
// (red_black.h), damped Jacobi twice before and twice after each coarse correction on the other grids, and black-box
// interpolation (interpolation.h).
#pragma once

#include <memory>
#include <vector>

#include "base/rows.h"
#include "reconstruct/poisson/interpolation.h"

namespace gradus::reconstruct {

// Work space of a cycle: values on the coarse grids. Multigrids of one size may share it, but only one cycle may run at
// a time.
class MultigridWork {
 public:
  MultigridWork(int width, int height, int channels);

 private:
  friend class Multigrid;
  struct Level {
    Field b, z, swept;
  };
  std::vector<Level> levels_;  // the first is empty: the caller owns the fields of the finest grid
};

class Multigrid {
 public:
  Multigrid(int width, int height, int channels)
      : Multigrid(width, height, std::make_shared<MultigridWork>(width, height, channels)) {}
  Multigrid(int width, int height, std::shared_ptr<MultigridWork> work);
  // The matrix of the finest grid. Fill it, then call update().
  Stencil& matrix() { return levels_.front().matrix; }
  const Stencil& matrix() const { return levels_.front().matrix; }
  // Computes the coarse matrices from the finest one.
  void update();
  // Writes z ≈ A⁻¹ b and returns b·z of each row. b must have the size of the grid and the number of channels of the
  // multigrid. Not thread-safe, neither for one multigrid nor for several that share their work space.
  RowSums cycle(const Field& b, Field* z);

 private:
  struct Level {
    Stencil matrix;
    Interpolation interpolation;  // from the next coarser grid to this one
  };
  // Runs the cycle on a coarse grid and all coarser ones. Reads the right side from the level's work space and returns
  // its z.
  const Field& solve_coarse(size_t level);
  std::vector<Level> levels_;
  std::shared_ptr<MultigridWork> work_;
};

}  // namespace gradus::reconstruct
