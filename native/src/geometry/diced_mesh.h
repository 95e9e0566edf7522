// A copy of a mesh with smaller triangles.
#pragma once

#include <memory>

#include "geometry/mesh.h"

namespace gradus::geometry {

// Returns a copy of the mesh whose triangles are divided in four at the middles of their edges, `levels` times. With
// smooth normals the middles lie on curved edges, of which neighbouring triangles have the same one. Source: Vlachos,
// Peters, Boyd and Mitchell, Curved PN Triangles (2001). Attributes are interpolated linearly.
std::shared_ptr<const MeshData> diced_mesh(const std::shared_ptr<const MeshData>& mesh, uint32_t levels);

}  // namespace gradus::geometry
