// Dicing: meshes of a snapshot are divided until their edges are short in the picture.
#pragma once

#include <memory>
#include <vector>

#include "base/commit_monitor.h"
#include "scene/snapshot.h"

namespace gradus::scene {

struct DicedMesh {
  std::shared_ptr<const geometry::MeshData> from, mesh;
  uint64_t view = 0;        // hash of the camera and the placements that it was diced for
  float longest = 0.0f;     // excess of its longest edge in that view, if it tolerates other views
  float coarseness = 1.0f;  // by how many times its edges are longer than asked for, since triangles are limited
  bool by_scene = false;    // the limit of the scene decides and not that of the mesh
};

// Maximum numbers of triangles of diced meshes.
struct DicingLimits {
  uint64_t mesh = uint64_t(1) << 23;
  uint64_t scene = uint64_t(1) << 24;
};

// An instance whose mesh is coarser than asked for.
struct CoarseInstance {
  size_t index = 0;
  float coarseness = 1.0f;
  bool by_scene = false;  // the limit of the scene decides
};

// Replaces the meshes that are to be diced. The longest edges of all meshes are divided first, until none is too long
// or a limit is reached, so that what a limit costs is spread evenly. The instance of a mesh that needs the shortest
// edges at a place decides there. `known` holds the results of the last commit, and receives those of this one. Returns
// the instances that a limit keeps coarse. Edges are measured in the picture of `camera`, which is in internal space.
std::vector<CoarseInstance> dice_instances(const CommitMonitor& monitor, const DicingLimits& limits,
                                           const GradusCamera& camera, std::vector<DicedMesh>* known,
                                           Snapshot* snapshot);

}  // namespace gradus::scene
