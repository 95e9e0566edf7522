// Cells of a lattice that is fixed to the full frame: work tiles, and the cells on which jitter is shared and noise is
// judged.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "film/film.h"
#include "film/pixel_block.h"

namespace gradus::film {

// Squares of `side` pixels, aligned to multiples of it, cut to the region; row by row.
std::vector<Region> make_pixel_blocks(const Region& region, int side = kPixelBlockSide);
Region intersection(const Region& a, const Region& b);

// The cells of a region, as rows and columns.
struct PixelBlockGrid {
  explicit PixelBlockGrid(const Region& region, int side = kPixelBlockSide);
  size_t index(int32_t column, int32_t row) const { return size_t(row) * size_t(columns) + size_t(column); }

  std::vector<Region> blocks;
  int32_t columns, rows;
};

// The cell and those around it, the near ones counting more: visit(cell, weight).
template <class Visit>
void for_each_around(const PixelBlockGrid& grid, size_t block, Visit&& visit) {
  const auto column = int32_t(block % size_t(grid.columns)), row = int32_t(block / size_t(grid.columns));
  for (int32_t y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
    for (int32_t x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x) {
      visit(grid.index(x, y), (x == column ? 2.0 : 1.0) * (y == row ? 2.0 : 1.0));
    }
  }
}

// Sets a part of a map that has a value for every pixel of the region.
template <class T>
void fill(const Region& part, const Region& region, T value, std::vector<T>* map) {
  for (int32_t y = part.y0; y < part.y1; ++y) {
    const size_t first = size_t(y - region.y0) * size_t(region.width()) + size_t(part.x0 - region.x0);
    std::fill_n(map->begin() + ptrdiff_t(first), part.width(), value);
  }
}

}  // namespace gradus::film
