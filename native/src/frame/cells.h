// Cells of a lattice that is fixed to the full frame: work tiles, and the cells on which jitter is shared and noise is judged.
#pragma once

#include <vector>

#include "frame/frame.h"
#include "sampling/lattice.h"

namespace gradus {

// Squares of `side` pixels, aligned to multiples of it, cut to the region; row by row.
std::vector<Region> make_cells(const Region& region, int side = kLattice);
Region intersection(const Region& a, const Region& b);

}  // namespace gradus
