// A static copy of a mesh at another time.
#pragma once

#include <memory>

#include "geometry/mesh.h"

namespace gradus::geometry {

// Returns a copy of the mesh as it is `frames` frames after the rendered frame (negative: before it), without motion.
// Normals rotate as the smooth normals of their vertices do. Attributes and generated coordinates stay the same.
std::shared_ptr<const MeshData> mesh_at(const MeshData& mesh, float frames);

}  // namespace gradus::geometry
