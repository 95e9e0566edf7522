// Embree's scenes behind a snapshot. A mesh with one user lies in the top level in world space (no price for instancing); a mesh with
// several is built once and referenced.
#pragma once

#include <functional>
#include <memory>
#include <unordered_map>
#include <vector>

#include "base/types.h"
#include "scene/flat_triangle.h"
#include "scene/mesh.h"
#include "scene/snapshot.h"

struct RTCSceneTy;
struct RTCGeometryTy;

namespace gradus {

class Device;

// Bits of Embree's ray masks beside GradusVisibility's.
inline constexpr uint32_t kMaskVisibility = GRADUS_VISIBLE_ALL;
inline constexpr uint32_t kMaskOpaqueShadow = 1u << 8;       // casts shadows, all of its materials opaque for them
inline constexpr uint32_t kMaskTransparentShadow = 1u << 9;  // casts shadows that a material may let through

// Called while building with the fraction done; false: stop.
using BuildProgress = std::function<bool(float)>;

// The acceleration structure of one mesh in its own space.
struct MeshScene {
  std::shared_ptr<Device> device;
  std::shared_ptr<const MeshData> mesh;
  RTCSceneTy* scene = nullptr;
  ~MeshScene();
};

// What is worth keeping from commit to commit.
using MeshSceneCache = std::unordered_map<const MeshData*, std::shared_ptr<const MeshScene>>;

struct Accelerator {
  std::shared_ptr<Device> device;
  RTCSceneTy* scene = nullptr;
  std::vector<std::shared_ptr<const MeshScene>> mesh_scenes;
  std::vector<std::shared_ptr<const MeshData>> meshes;             // whose index buffers the top level reads
  std::vector<std::unique_ptr<std::vector<Vec3>>> flat_positions;  // likewise, of its vertices
  std::vector<FlatTriangles> flat_triangles;                       // of each instance; empty: not in the top level
  ~Accelerator();
};

struct AcceleratorInput {
  const std::vector<InstanceData>* instances;
  const std::vector<uint32_t>* masks;             // Embree mask of each instance
  std::function<glm::dmat4(size_t)> to_internal;  // exact matrix of each instance; InstanceData::to_world is rounded
};

// Throws Error CANCELLED or OUT_OF_MEMORY. The instances' flat_triangles are left to the caller.
std::shared_ptr<const Accelerator> build_accelerator(const std::shared_ptr<Device>& device, const AcceleratorInput& input,
                                                     const BuildProgress& progress, MeshSceneCache* cache);

// Queries with a mask of the bits above. Rays that are not finite miss.
bool trace_nearest(const Accelerator& accelerator, const Ray& ray, uint32_t mask, Hit* hit);
bool trace_any(const Accelerator& accelerator, const Ray& ray, uint32_t mask);

}  // namespace gradus
