#include "film/pixel_blocks.h"

#include <algorithm>

namespace gradus::film {

Region intersection(const Region& a, const Region& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

std::vector<Region> make_pixel_blocks(const Region& region, int side) {
  std::vector<Region> blocks;
  for (int32_t y = pixel_block_of(region.y0, side) * side; y < region.y1; y += side) {
    for (int32_t x = pixel_block_of(region.x0, side) * side; x < region.x1; x += side) {
      blocks.push_back(intersection({x, y, x + side, y + side}, region));
    }
  }
  return blocks;
}

PixelBlockGrid::PixelBlockGrid(const Region& region, int side)
    : blocks(make_pixel_blocks(region, side)),
      columns(pixel_block_of(region.x1 - 1, side) - pixel_block_of(region.x0, side) + 1),
      rows(pixel_block_of(region.y1 - 1, side) - pixel_block_of(region.y0, side) + 1) {}

}  // namespace gradus::film
