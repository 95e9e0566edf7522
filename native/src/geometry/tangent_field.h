// Tangents that follow a UV map smoothly: those that normal maps are baked for.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace gradus::geometry {

// At each vertex the mean of the triangles' directions of increasing u, weighed by their angles there; apart for
// corners that differ in normal or UV coordinates or see the map from its other side. Source: M. Mikkelsen, Simulation
// of Wrinkled Surfaces Revisited (2008), 3.3, whose convention (MikkTSpace) Blender, Cycles and bakers share.
struct TangentField {
  const MeshAttribute* uv = nullptr;      // of the mesh it was made for
  std::shared_ptr<const MeshData> mesh;   // keeps it alive
  std::vector<uint32_t> corner_tangents;  // 3 per triangle: index in `tangents`
  std::vector<Vec4> tangents;             // local, unit; w: handedness, ±1. All 0: the map gives no direction there

  std::array<Vec4, 3> corners(uint32_t triangle) const;
};

std::shared_ptr<const TangentField> make_tangents(const std::shared_ptr<const MeshData>& mesh, const MeshAttribute& uv);

}  // namespace gradus::geometry
