// Dicing: meshes of a snapshot are divided until their edges are short in the picture.
#pragma once

#include <memory>
#include <vector>

#include "base/commit_monitor.h"
#include "scene/snapshot.h"

namespace gradus::scene {

struct DicedMesh {
  std::shared_ptr<const geometry::MeshData> from, mesh;
  uint32_t levels = 0;
};

// Replaces the meshes that are to be diced. All triangles of a mesh are divided equally often, so that it has no cracks
// and keeps its topology while a camera moves a little; the first instance of a mesh decides how often. `known` holds
// the results of the last commit, and receives those of this one. Returns the indices of the instances that a limit on
// the number of triangles keeps coarse. The snapshot must have a camera.
std::vector<size_t> dice_instances(const CommitMonitor& monitor, std::vector<DicedMesh>* known, Snapshot* snapshot);

}  // namespace gradus::scene
