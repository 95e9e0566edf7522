// What a hit on a triangle needs, in two records that follow each other in random order. In large scenes each further
// cache line would cost the latency of main memory.
#pragma once

#include "base/huge_pages.h"
#include "geometry/mesh.h"
#include "geometry/plane.h"

namespace gradus::geometry {

// One cache line.
struct alignas(64) TriangleRecord {
  std::array<Vec3, 3> corners;
  Plane plane;        // plane of the corners; a mirrored instance has the opposite normal
  uint32_t slot = 0;  // material slot
};
static_assert(sizeof(TriangleRecord) == 64);

// The shading normals at the corners, not normalised.
struct NormalRecord {
  std::array<Vec3, 3> corners;
};

// The records of a mesh that does not deform while the shutter is open.
struct TriangleRecords {
  bool is_in_internal_space = false;  // else in the mesh's own space
  HugePageVector<TriangleRecord> triangles;
  HugePageVector<NormalRecord> normals;  // empty: the mesh is shaded flat
};

// Returns the records of a mesh in the space of `positions`, which holds the position of each vertex there.
// `normal_to_space` transforms normals to that space. Dropped triangles have default values, because no ray hits them.
TriangleRecords make_triangle_records(const MeshData& mesh, const Vec3* positions, const Mat3& normal_to_space);

}  // namespace gradus::geometry
