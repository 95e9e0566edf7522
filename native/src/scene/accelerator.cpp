#include "scene/accelerator.h"

#include <span>

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include "base/device.h"
#include "base/error.h"

namespace gradus {

namespace {

// Meshes whose copies hold no more triangles than this in sum are copied into the top level: cheaper to trace than instances.
constexpr uint64_t kMaxCopiedTriangles = 1u << 14;

struct Monitor {
  const BuildProgress* progress;
  float first, last;
};

bool on_progress(void* data, double fraction) {
  const auto* m = static_cast<const Monitor*>(data);
  return (*m->progress)(m->first + (m->last - m->first) * float(fraction));
}

// Without memory for what grows with the scene, nodes and leaves, Embree gives back what it has and says so. Where the few bytes of a
// build's entry in its thread pool are refused, it keeps the pool's lock (3.13.5, ThreadPool::add), and the next build waits for ever: that
// only tests refuse (tests/memory/embree_guard.cpp).
void commit_scene(RTCDevice device, RTCScene scene, const BuildProgress& progress, float first, float last) {
  Monitor monitor{&progress, first, last};
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  rtcSetSceneProgressMonitorFunction(scene, on_progress, &monitor);
  rtcCommitScene(scene);
  rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_CANCELLED || !progress(last)) throw cancelled();
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw Error(GRADUS_ERROR_OUT_OF_MEMORY, "out of memory while building the acceleration structure");
  if (error != RTC_ERROR_NONE) throw Error(GRADUS_ERROR_UNKNOWN, "Embree failed with code " + std::to_string(int(error)));
}

// positions: key after key.
void attach_triangles(RTCDevice device, RTCScene scene, unsigned id, unsigned mask, const MeshData& mesh, const Vec3* positions,
                      unsigned keys) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, keys);
  for (unsigned k = 0; k < keys; ++k)
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, k, RTC_FORMAT_FLOAT3, positions, k * mesh.vertex_count * sizeof(Vec3),
                               sizeof(Vec3), mesh.vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangle_vertices.data(), 0, 3 * sizeof(uint32_t),
                             mesh.triangle_count);
  rtcSetGeometryMask(geometry, mask);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

void attach_instance(RTCDevice device, RTCScene scene, unsigned id, unsigned mask, RTCScene instanced, const InstanceData& instance) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, instanced);
  const std::span<const Mat4> keys = instance.keys ? std::span(instance.keys->keys()) : std::span(&instance.to_world, 1);
  rtcSetGeometryTimeStepCount(geometry, unsigned(keys.size()));
  for (unsigned i = 0; i < keys.size(); ++i) rtcSetGeometryTransform(geometry, i, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &keys[i][0][0]);
  rtcSetGeometryMask(geometry, mask);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

std::shared_ptr<const MeshScene> build_mesh_scene(const std::shared_ptr<Device>& device, const std::shared_ptr<const MeshData>& mesh,
                                                  const BuildProgress& progress, float at) {
  auto built = std::make_shared<MeshScene>();
  built->device = device;
  built->mesh = mesh;
  built->scene = rtcNewScene(device->embree());
  const bool deforms = mesh->shutter_keys > 0;
  attach_triangles(device->embree(), built->scene, 0, 0xffffffffu, *mesh, deforms ? mesh->shutter_positions.data() : mesh->rest_positions(),
                   deforms ? mesh->shutter_keys : 1);
  commit_scene(device->embree(), built->scene, progress, at, at);
  return built;
}

// In double: a mesh that lies far from its own origin may be brought back by its matrix.
std::unique_ptr<std::vector<Vec3>> transform_positions(const MeshData& mesh, const glm::dmat4& m) {
  auto out = std::make_unique<std::vector<Vec3>>(size_t(mesh.vertex_count) + 1);
  const Vec3* in = mesh.rest_positions();
  tbb::parallel_for(tbb::blocked_range<size_t>(0, mesh.vertex_count, 1 << 14), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) (*out)[i] = Vec3(m * glm::dvec4(glm::dvec3(in[i]), 1.0));
  });
  return out;
}

using UserCounts = std::unordered_map<const MeshData*, uint64_t>;

bool lies_in_top_level(const InstanceData& instance, const UserCounts& users) {
  if (instance.moves()) return false;
  const uint64_t count = users.at(instance.mesh.get());
  return count == 1 || count * instance.mesh->triangle_count <= kMaxCopiedTriangles;
}

}  // namespace

MeshScene::~MeshScene() {
  if (scene) rtcReleaseScene(scene);
}

Accelerator::~Accelerator() {
  if (scene) rtcReleaseScene(scene);
}

std::shared_ptr<const Accelerator> build_accelerator(const std::shared_ptr<Device>& device, const AcceleratorInput& input,
                                                     const BuildProgress& progress, MeshSceneCache* cache) {
  constexpr float kMeshShare = 0.4f;  // of the progress
  auto built = std::make_shared<Accelerator>();
  const std::vector<InstanceData>& instances = *input.instances;
  const std::vector<uint32_t>& masks = *input.masks;
  built->device = device;
  built->scene = rtcNewScene(device->embree());
  UserCounts users;
  for (const InstanceData& instance : instances) ++users[instance.mesh.get()];
  MeshSceneCache kept;
  for (size_t i = 0; i < instances.size(); ++i) {
    const InstanceData& instance = instances[i];
    const float done = kMeshShare * float(i) / float(instances.size());
    if ((i & 255) == 0 && !progress(done)) throw cancelled();
    if (lies_in_top_level(instance, users)) {
      built->flat_positions.push_back(transform_positions(*instance.mesh, input.to_internal(i)));
      built->meshes.push_back(instance.mesh);
      attach_triangles(device->embree(), built->scene, unsigned(i), masks[i], *instance.mesh, built->flat_positions.back()->data(), 1);
      continue;
    }
    auto& mesh_scene = kept[instance.mesh.get()];
    if (!mesh_scene) {
      const auto old = cache->find(instance.mesh.get());
      mesh_scene = old != cache->end() ? old->second : build_mesh_scene(device, instance.mesh, progress, done);
      built->mesh_scenes.push_back(mesh_scene);
    }
    attach_instance(device->embree(), built->scene, unsigned(i), masks[i], mesh_scene->scene, instance);
  }
  commit_scene(device->embree(), built->scene, progress, kMeshShare, 1.0f);
  size_t flat = 0;
  for (const InstanceData& instance : instances) {
    FlatTriangles& triangles = built->flat_triangles.emplace_back();
    if (lies_in_top_level(instance, users)) triangles = make_flat_triangles(*instance.mesh, built->flat_positions[flat++]->data());
  }
  *cache = std::move(kept);
  return built;
}

}  // namespace gradus
