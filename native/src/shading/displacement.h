// Displacement of surfaces by the program of their material: as a bump of the shading normal, or of the vertices of a
// mesh.
#pragma once

#include <vector>

#include "base/commit_monitor.h"
#include "shading/context.h"

namespace gradus::shading {

struct MaterialData;  // shading/material.h

// Returns the shading normal of a point of a surface, bent by the displacement of its material, which `bumps`.
Vec3 displacement_bump(const MaterialData& material, const ShadeContext& context);

// The true displacement of a mesh.
struct VertexOffsets {
  std::vector<Vec3> offsets;  // of each vertex, in the mesh's space
  std::vector<bool> moves;    // for each triangle: its material moves its vertices
  size_t not_finite = 0;      // number of vertices whose offset was replaced by 0
};

// Evaluates the materials of an instance at the vertices of its mesh, in the rendered frame. Like in Cycles, a vertex
// moves by the material of its first triangle that displaces. Offsets that are not finite, or longer than Embree can
// trace, are 0. `index` is that of the instance in the scene; `instance` is a copy with the tangents that its materials
// read. Throws Error CANCELLED if the monitor says so.
VertexOffsets evaluate_offsets(const ShadedScene& scene, uint32_t index, const geometry::InstanceData& instance,
                               const CommitMonitor& monitor);

}  // namespace gradus::shading
