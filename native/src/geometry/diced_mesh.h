// A copy of a mesh with smaller triangles.
#pragma once

#include <memory>

#include "geometry/dicing.h"
#include "geometry/mesh.h"

namespace gradus::geometry {

// Returns a copy of the mesh with the triangles of its dicing. With smooth normals the new vertices lie on curved
// patches. Attributes are interpolated linearly. Throws Error CANCELLED if the monitor says so.
std::shared_ptr<const MeshData> diced_mesh(const Dicing& dicing, const CommitMonitor& monitor);

}  // namespace gradus::geometry
