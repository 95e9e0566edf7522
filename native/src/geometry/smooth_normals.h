// Normals of vertices where the caller gives none.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace gradus::geometry {

// Unit normals of all vertices where they stand at `positions`: those of the triangles around, weighted by their angles
// (Thürmer and Wüthrich, Computing Vertex Normals from Polygonal Facets, 1998), as Blender does. Summed in order of
// triangles, so that equal meshes have equal bits: Blender before 4.0 sums in any order, and its normals differ in the
// last bit between two evaluations. Vertices without area: 0.
std::vector<Vec3> smooth_normals(const MeshData& mesh, const Vec3* positions);

}  // namespace gradus::geometry
