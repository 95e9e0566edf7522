#include "frame/cells.h"

#include <algorithm>

namespace gradus {

Region intersection(const Region& a, const Region& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

std::vector<Region> make_cells(const Region& region, int side) {
  std::vector<Region> cells;
  for (int32_t y = lattice_cell(region.y0, side) * side; y < region.y1; y += side) {
    for (int32_t x = lattice_cell(region.x0, side) * side; x < region.x1; x += side) {
      cells.push_back(intersection({x, y, x + side, y + side}, region));
    }
  }
  return cells;
}

CellGrid::CellGrid(const Region& region, int side)
    : cells(make_cells(region, side)),
      columns(lattice_cell(region.x1 - 1, side) - lattice_cell(region.x0, side) + 1),
      rows(lattice_cell(region.y1 - 1, side) - lattice_cell(region.y0, side) + 1) {}

}  // namespace gradus
