// What a hit needs of a triangle that lies in the top level, in one cache line: in large scenes each line costs the
// latency of memory.
#pragma once

#include "base/huge_pages.h"
#include "geometry/mesh.h"
#include "geometry/plane.h"

namespace gradus::geometry {

struct alignas(64) FlatTriangle {
  std::array<Vec3, 3> corners;  // in internal space
  Plane plane;                  // of the corners: a mirrored instance's normal is its opposite
  uint32_t slot = 0;            // of the material
};
static_assert(sizeof(FlatTriangle) == 64);

using FlatTriangles = HugePageVector<FlatTriangle>;

// positions: of the mesh's vertices, in internal space.
FlatTriangles make_flat_triangles(const MeshData& mesh, const Vec3* positions);

}  // namespace gradus::geometry
