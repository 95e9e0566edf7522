// One symmetric V-cycle as preconditioner: z ≈ A⁻¹ b. Damped Jacobi once before and once after, cells of 2×2, constant interpolation.
#pragma once

#include <vector>

#include "reconstruct/weighted_system.h"

namespace gradus {

class Multigrid {
 public:
  Multigrid(int width, int height, int channels);
  // The finest system, to be filled; then update().
  WeightedSystem& system() { return levels_.front().system; }
  const WeightedSystem& system() const { return levels_.front().system; }
  // Makes the coarse systems from the finest.
  void update();
  // Overwrites z; b must have the grid's size and the multigrid's channels. Not for two threads at once: work space is its own.
  void cycle(const Field& b, Field* z);

 private:
  struct Level {
    WeightedSystem system;
    Field b, x, z;  // of coarse levels; of the finest one only x
  };
  void cycle(size_t level, const Field& b, Field* z);
  std::vector<Level> levels_;
};

}  // namespace gradus
