// True displacement: a stage of the commit between the compilation of materials and the acceleration structure.
#pragma once

#include <memory>
#include <vector>

#include "base/commit_monitor.h"
#include "geometry/geometry.h"
#include "scene/snapshot.h"

namespace gradus::scene {

// A mesh that its materials have displaced, with what the result depends on.
struct DisplacedMesh {
  geometry::InstanceData from;                                          // the instance before, with its tangents
  std::vector<std::shared_ptr<const shading::MaterialData>> materials;  // of its slots
  std::shared_ptr<const geometry::MeshData> mesh;                       // equal to that of `from` if no vertex moves
  size_t not_finite = 0;                                                // vertices that kept their place
};

// Replaces the meshes of instances whose materials move vertices. Instances of one mesh with the same materials share
// the result, which is that of the first of them, as in Cycles. `known` holds the results of the last commit, which are
// reused if nothing that they depend on has changed, and receives those of this one. Returns the indices of the
// instances with vertices whose displacement is not finite. The instances must have materials.
std::vector<size_t> displace_instances(const CommitMonitor& monitor, std::vector<DisplacedMesh>* known,
                                       Snapshot* snapshot);

}  // namespace gradus::scene
