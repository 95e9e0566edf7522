// A group of instances in one Embree scene. A mesh with one user is copied into the top level of the scene in internal
// space, which avoids the cost of instancing. A mesh with several users is built once and referenced.
#pragma once

#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "base/commit_monitor.h"
#include "base/types.h"
#include "geometry/embree_device.h"
#include "geometry/geometry.h"
#include "geometry/mesh.h"
#include "geometry/ray_box.h"
#include "geometry/triangle_records.h"

struct RTCSceneTy;

namespace gradus::geometry {

// The acceleration structure of one mesh in its own space.
struct MeshScene {
  EmbreeDevice device;
  std::shared_ptr<const MeshData> mesh;
  RTCSceneTy* scene = nullptr;
  std::shared_ptr<const TriangleRecords> records;  // null: the mesh deforms
  ~MeshScene();
};

using MeshScenes = std::unordered_map<const MeshData*, std::shared_ptr<const MeshScene>>;

// Function that returns the matrix to internal space of an instance, by index, in double precision.
// InstanceData::to_world is rounded to float.
using ExactMatrices = std::function<glm::dmat4(size_t)>;

// The instances from which a group is built.
struct GroupInput {
  struct Member {
    uint32_t instance;  // index in `instances`
    uint32_t mask;      // Embree ray mask
    bool flat;          // the triangles are copied into the top level
  };
  const std::vector<InstanceData>* instances;
  const ExactMatrices* to_internal;
  std::vector<Member> members;

  const InstanceData& instance(const Member& member) const { return (*instances)[member.instance]; }
  // Returns a hash of the input. Inputs with equal keys give equal groups.
  uint64_t key() const;
};

// An immutable Embree scene of several instances. Embree's geometry ids are indices in the list of members. The
// snapshot's index of a member may change from snapshot to snapshot; Accelerator::Part maps members to instances.
struct GeometryGroup {
  EmbreeDevice device;
  uint64_t key = 0;  // GroupInput::key() of its input
  RTCSceneTy* scene = nullptr;
  std::vector<std::shared_ptr<const MeshScene>> mesh_scenes;
  std::vector<std::shared_ptr<const MeshData>> meshes;             // keep the index buffers that the top level reads
  std::vector<std::unique_ptr<std::vector<Vec3>>> flat_positions;  // vertex buffers that the top level reads
  // Records of each member: in internal space if it is flat, else in its own space; null if it deforms.
  std::vector<std::shared_ptr<const TriangleRecords>> records;
  RayBox box;  // bounds while the shutter is open
  ~GeometryGroup();
};

// Builds a group. `key` is input.key(). `known` holds the existing mesh scenes; new ones are added to it. Throws Error
// CANCELLED or OUT_OF_MEMORY.
std::shared_ptr<const GeometryGroup> build_group(const EmbreeDevice& device, const GroupInput& input, uint64_t key,
                                                 const BuildProgress& progress, MeshScenes* known);

}  // namespace gradus::geometry
