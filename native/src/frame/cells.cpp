#include "frame/cells.h"

#include <algorithm>

namespace gradus {

namespace {

// Below 0, too, towards minus infinity.
int32_t align_down(int32_t x, int side) { return x >= 0 ? x / side * side : -((-x + side - 1) / side) * side; }

}  // namespace

Region intersection(const Region& a, const Region& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

std::vector<Region> make_cells(const Region& region, int side) {
  std::vector<Region> cells;
  for (int32_t y = align_down(region.y0, side); y < region.y1; y += side) {
    for (int32_t x = align_down(region.x0, side); x < region.x1; x += side) {
      cells.push_back(intersection({x, y, x + side, y + side}, region));
    }
  }
  return cells;
}

}  // namespace gradus
