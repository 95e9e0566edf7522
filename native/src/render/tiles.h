// Work tiles: aligned to a fixed lattice of full-frame coordinates; each with a lock, so that passes can be read while others sample.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "frame/cells.h"

namespace gradus {

// 32 where there are enough tiles to keep the threads busy, else 16. A multiple of kLattice.
int tile_side(const Region& region, unsigned threads);

class TileGrid {
 public:
  TileGrid(const Region& region, int side);
  size_t size() const { return tiles_.size(); }
  const Region& tile(size_t i) const { return tiles_[i]; }
  // Held while a tile is sampled, and while it is read.
  std::unique_lock<std::mutex> lock(size_t i) const { return std::unique_lock(locks_[i]); }
  // In order of index; samplers hold one lock at most, so this ends.
  std::vector<std::unique_lock<std::mutex>> lock_all() const;

 private:
  std::vector<Region> tiles_;
  std::unique_ptr<std::mutex[]> locks_;
};

// Reads a pass of a frame that is being sampled under the tiles' locks; see read_frame_pass().
void read_pass_by_tiles(const Frame& frame, const TileGrid& grid, uint32_t pass, const Region& region, float* pixels);

}  // namespace gradus
