// Some of a snapshot's instances in a scene of Embree's. A mesh with one user lies in its top level in world space (no
// price for instancing); a mesh with several is built once and referenced.
#pragma once

#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "base/commit_monitor.h"
#include "base/types.h"
#include "geometry/embree_device.h"
#include "geometry/flat_triangle.h"
#include "geometry/geometry.h"
#include "geometry/mesh.h"
#include "geometry/ray_box.h"

struct RTCSceneTy;

namespace gradus::geometry {

// The acceleration structure of one mesh in its own space.
struct MeshScene {
  EmbreeDevice device;
  std::shared_ptr<const MeshData> mesh;
  RTCSceneTy* scene = nullptr;
  ~MeshScene();
};

using MeshScenes = std::unordered_map<const MeshData*, std::shared_ptr<const MeshScene>>;

// Exact matrix of each instance; InstanceData::to_world is rounded.
using ExactMatrices = std::function<glm::dmat4(size_t)>;

struct GroupInput {
  struct Member {
    uint32_t instance;
    uint32_t mask;  // Embree's
    bool flat;      // in the top level
  };
  const std::vector<InstanceData>* instances;
  const ExactMatrices* to_internal;
  std::vector<Member> members;

  const InstanceData& instance(const Member& member) const { return (*instances)[member.instance]; }
  // Equal where a group that was built of one input is that of the other.
  uint64_t key() const;
};

// Immutable. Embree's geometry ids are places in the list of members: which instances these are may change from
// snapshot to snapshot.
struct GeometryGroup {
  EmbreeDevice device;
  uint64_t key = 0;  // of its input
  RTCSceneTy* scene = nullptr;
  std::vector<std::shared_ptr<const MeshScene>> mesh_scenes;
  std::vector<std::shared_ptr<const MeshData>> meshes;             // whose index buffers the top level reads
  std::vector<std::unique_ptr<std::vector<Vec3>>> flat_positions;  // likewise, of its vertices
  std::vector<FlatTriangles> flat_triangles;                       // of each member; empty: not in the top level
  RayBox box;                                                      // around all, as long as the shutter is open
  ~GeometryGroup();
};

// key: the input's. known: mesh scenes that exist; those that are built are added. Throws Error CANCELLED or
// OUT_OF_MEMORY.
std::shared_ptr<const GeometryGroup> build_group(const EmbreeDevice& device, const GroupInput& input, uint64_t key,
                                                 const BuildProgress& progress, MeshScenes* known);

}  // namespace gradus::geometry
