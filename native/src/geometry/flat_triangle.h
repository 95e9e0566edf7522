// The data of a top-level triangle that a hit needs, in one cache line. In large scenes each further cache line would
// cost the latency of main memory.
#pragma once

#include "base/huge_pages.h"
#include "geometry/mesh.h"
#include "geometry/plane.h"

namespace gradus::geometry {

struct alignas(64) FlatTriangle {
  std::array<Vec3, 3> corners;  // in internal space
  Plane plane;                  // plane of the corners; a mirrored instance has the opposite normal
  uint32_t slot = 0;            // material slot
};
static_assert(sizeof(FlatTriangle) == 64);

using FlatTriangles = HugePageVector<FlatTriangle>;

// Returns the triangles of a mesh in internal space. `positions` holds the internal-space position of each vertex.
// Dropped triangles keep default values, because no ray hits them.
FlatTriangles make_flat_triangles(const MeshData& mesh, const Vec3* positions);

}  // namespace gradus::geometry
