#include "render/tiles.h"

#include <algorithm>

#include "render/pass_read.h"
#include "render/pass_table.h"

namespace gradus {
namespace {

// These look at neighbours, or at the frame as a whole.
bool needs_whole_frame(uint32_t pass) {
  return pass == GRADUS_PASS_GRADIENT_X || pass == GRADUS_PASS_GRADIENT_Y || pass == GRADUS_PASS_VARIANCE;
}

}  // namespace

int tile_side(const Region& region, unsigned threads) {
  constexpr int64_t kTilesPerThread = 16;
  const int64_t large = region.area() / (4 * kLattice * kLattice);
  return large >= kTilesPerThread * int64_t(threads) ? 2 * kLattice : kLattice;
}

TileGrid::TileGrid(const Region& region, int side)
    : tiles_(make_cells(region, side)), locks_(std::make_unique<std::mutex[]>(tiles_.size())) {}

std::vector<std::unique_lock<std::mutex>> TileGrid::lock_all() const {
  std::vector<std::unique_lock<std::mutex>> locks;
  locks.reserve(size());
  for (size_t i = 0; i < size(); ++i) locks.push_back(lock(i));
  return locks;
}

void read_pass_by_tiles(const Frame& frame, const TileGrid& grid, uint32_t pass, const Region& region, float* pixels) {
  if (needs_whole_frame(pass)) {
    const auto locks = grid.lock_all();
    return read_frame_pass(frame, pass, region, pixels);
  }
  const uint32_t channels = pass_info(pass).channels;
  std::vector<float> part;
  for (size_t i = 0; i < grid.size(); ++i) {
    const Region tile = intersection(grid.tile(i), region);
    if (tile.width() <= 0 || tile.height() <= 0) continue;
    part.resize(size_t(tile.area()) * channels);
    {
      const auto lock = grid.lock(i);
      read_frame_pass(frame, pass, tile, part.data());
    }
    const size_t row = size_t(tile.width()) * channels;
    for (int32_t y = tile.y0; y < tile.y1; ++y) {
      const size_t to = (size_t(y - region.y0) * size_t(region.width()) + size_t(tile.x0 - region.x0)) * channels;
      std::copy_n(part.data() + size_t(y - tile.y0) * row, row, pixels + to);
    }
  }
}

}  // namespace gradus
