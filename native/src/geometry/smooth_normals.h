// Smooth vertex normals, for meshes whose caller gives none.
#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace gradus::geometry {

// Returns the unit normals of all vertices, for vertices at `positions`. A vertex normal is the sum of the normals of
// the adjacent polygons, weighted by their angles at the vertex, as in Blender. A vertex without adjacent area has the
// normal 0. Source: Thürmer and Wüthrich, Computing Vertex Normals from Polygonal Facets (1998). The normals are summed
// in the order of the polygons, so that equal meshes have bitwise equal normals. Blender before 4.0 sums in an
// arbitrary order, and its normals differ in the last bit between two evaluations.
// Throws Error CANCELLED if the monitor says so.
std::vector<Vec3> smooth_normals(const MeshData& mesh, const Vec3* positions,
                                 const CommitMonitor& monitor = {nullptr, nullptr});

}  // namespace gradus::geometry
