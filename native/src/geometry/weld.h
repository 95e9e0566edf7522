// Vertices at one place, which count as one where a mesh is split.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/types.h"

namespace gradus::geometry {

// Returns, for each vertex, the vertex that stands for all vertices at its place. Two vertices are at one place if
// their distance is below 0.00035 and the sums of their coordinates are equal but for rounding, as in Cycles. Vertices
// whose positions are not finite stand for themselves. Takes time O(n log n).
std::vector<uint32_t> weld(const Vec3* positions, size_t count);

}  // namespace gradus::geometry
