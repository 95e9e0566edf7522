// A copy of a mesh whose vertices have moved.
#pragma once

#include <memory>
#include <vector>

#include "geometry/mesh.h"

namespace gradus::geometry {

// Returns a copy of the mesh with its vertices moved by `offsets` at all times. Generated coordinates and attributes
// stay with the vertices. `moves` says of each triangle whether it gets new smooth normals: the mean of the normals of
// such triangles at a vertex, as in Cycles. Corners at one vertex with equal normals keep equal ones; others stay
// sharp. Throws Error CANCELLED if the monitor says so.
std::shared_ptr<const MeshData> displaced_mesh(const MeshData& mesh, const std::vector<Vec3>& offsets,
                                               const std::vector<bool>& moves,
                                               const CommitMonitor& monitor = {nullptr, nullptr});

}  // namespace gradus::geometry
