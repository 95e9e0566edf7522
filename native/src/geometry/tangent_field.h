// Smooth tangents of a UV map, as tangent-space normal maps require them.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace gradus::geometry {

// Tangents at the corners of a mesh. The tangent at a vertex is the mean of the adjacent triangles' directions of
// increasing u, weighted by their angles at the vertex. Corners that differ in normal, UV coordinates or handedness, or
// whose triangles meet at no edge that is connected in the UV map, have separate tangents. Source: M. Mikkelsen,
// Simulation of Wrinkled Surfaces Revisited (2008), 3.3. Blender, Cycles and bakers use the same convention
// (MikkTSpace).
struct TangentField {
  const MeshAttribute* uv = nullptr;      // UV map, owned by `mesh`
  std::shared_ptr<const MeshData> mesh;   // the mesh, which stays alive with the field
  std::vector<uint32_t> corner_tangents;  // 3 per triangle: index in `tangents`
  std::vector<Vec4> tangents;             // local, unit; w: handedness, ±1. 0: the map defines no direction

  // Returns the tangents at the corners of a triangle.
  std::array<Vec4, 3> corners(uint32_t triangle) const;
};

// Computes the tangents of a UV map `uv` of the mesh. Throws Error CANCELLED if the monitor says so.
std::shared_ptr<const TangentField> make_tangents(const std::shared_ptr<const MeshData>& mesh, const MeshAttribute& uv,
                                                  const CommitMonitor& monitor = {nullptr, nullptr});

}  // namespace gradus::geometry
