// A mesh as it is at one of the moments that it knows.
#pragma once

#include <memory>

#include "geometry/mesh.h"

namespace gradus::geometry {

// The same triangles where they are `frames` after the frame rendered, resting there. Normals turn as the smooth
// normals of their vertices do; what is painted on stays.
std::shared_ptr<const MeshData> mesh_at(const MeshData& mesh, float frames);

}  // namespace gradus::geometry
