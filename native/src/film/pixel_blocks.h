// Pixel blocks of 16×16 pixels, aligned to the full frame, and grids of such blocks. The pixels of a block share
// sub-pixel jitter, and adaptive sampling estimates noise per block. Work tiles are larger blocks.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/region.h"

namespace gradus::film {

inline constexpr int32_t kPixelBlockSide = 16;

// Returns the index of the block that contains coordinate x: x / side, rounded towards minus infinity.
inline int32_t pixel_block_of(int32_t x, int32_t side = kPixelBlockSide) {
  return x >= 0 ? x / side : -((-x + side - 1) / side);
}

// Returns the blocks of `side`×`side` pixels, aligned to multiples of `side` and clipped to the region, row-major.
std::vector<Region> make_pixel_blocks(const Region& region, int side = kPixelBlockSide);
// Returns the pixels that both regions contain.
Region intersection(const Region& a, const Region& b);

// The pixel blocks of a region, indexed by column and row.
struct PixelBlockGrid {
  explicit PixelBlockGrid(const Region& region, int side = kPixelBlockSide);
  size_t index(int32_t column, int32_t row) const { return size_t(row) * size_t(columns) + size_t(column); }

  std::vector<Region> blocks;
  int32_t columns, rows;
};

// Calls visit(block index, weight) for a block and its neighbours. Weights are 4 for the block, 2 for neighbours at its
// sides and 1 at its corners.
template <class Visit>
void for_each_around(const PixelBlockGrid& grid, size_t block, Visit&& visit) {
  const auto column = int32_t(block % size_t(grid.columns)), row = int32_t(block / size_t(grid.columns));
  for (int32_t y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
    for (int32_t x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x) {
      visit(grid.index(x, y), (x == column ? 2.0 : 1.0) * (y == row ? 2.0 : 1.0));
    }
  }
}

// Sets the pixels of `part` to `value` in a map with one value per pixel of `region`.
template <class T>
void fill(const Region& part, const Region& region, T value, std::vector<T>* map) {
  for (int32_t y = part.y0; y < part.y1; ++y) {
    const size_t first = region.index(part.x0, y);
    std::fill_n(map->begin() + ptrdiff_t(first), part.width(), value);
  }
}

}  // namespace gradus::film
