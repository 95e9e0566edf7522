// One symmetric V-cycle as preconditioner: z ≈ A⁻¹ b. Damped Jacobi once before and once after, black-box interpolation.
#pragma once

#include <memory>
#include <vector>

#include "reconstruct/interpolation.h"
#include "reconstruct/rows.h"

namespace gradus {

// Values on coarse grids while a cycle runs. Multigrids of one size may share it, one cycle at a time.
class MultigridWork {
 public:
  MultigridWork(int width, int height, int channels);

 private:
  friend class Multigrid;
  struct Level {
    Field b, z;
  };
  std::vector<Level> levels_;  // the first is empty: its fields are the caller's
};

class Multigrid {
 public:
  Multigrid(int width, int height, int channels) : Multigrid(width, height, std::make_shared<MultigridWork>(width, height, channels)) {}
  Multigrid(int width, int height, std::shared_ptr<MultigridWork> work);
  // The finest matrix, to be filled; then update().
  Stencil& matrix() { return levels_.front().matrix; }
  const Stencil& matrix() const { return levels_.front().matrix; }
  // Makes the coarse matrices from the finest.
  void update();
  // Overwrites z and returns b·z of each row; b must have the grid's size and the multigrid's channels. Not for two threads at once, nor
  // for two multigrids that share their work space.
  RowSums cycle(const Field& b, Field* z) { return cycle(0, b, z); }
  // z += what cycle() makes of b.
  void add_cycle(const Field& b, Field* z);

 private:
  struct Level {
    Stencil matrix;
    Interpolation interpolation;  // from the next one
  };
  RowSums cycle(size_t level, const Field& b, Field* z);
  // What the grids below a level make of b.
  const Field& coarse_solution(size_t level, const Field& b);
  std::vector<Level> levels_;
  std::shared_ptr<MultigridWork> work_;
};

}  // namespace gradus
