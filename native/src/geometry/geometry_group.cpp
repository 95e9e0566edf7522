#include "geometry/geometry_group.h"

#include <span>
#include <unordered_set>

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include "base/error.h"
#include "base/hash.h"

namespace gradus::geometry {

namespace {

// Maps the progress of one Embree build to the interval first..last of a whole build.
struct Monitor {
  const BuildProgress* progress;
  float first, last;
};

// Embree's progress callback. Returning false cancels the build.
bool on_progress(void* data, double fraction) {
  const auto* m = static_cast<const Monitor*>(data);
  return (*m->progress)(m->first + (m->last - m->first) * float(fraction));
}

// Builds an Embree scene. Throws Error CANCELLED, OUT_OF_MEMORY or UNKNOWN. If the allocation of nodes and leaves
// fails, Embree frees its memory and reports an error. If the few bytes of a build's entry in its thread pool cannot
// be allocated, Embree 3.13.5 keeps the pool's lock (ThreadPool::add), and the next build waits forever. Only tests
// make so small an allocation fail (tests/memory/embree_guard.cpp).
void commit_scene(RTCDevice device, RTCScene scene, const BuildProgress& progress, float first, float last) {
  Monitor monitor{&progress, first, last};
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  rtcSetSceneProgressMonitorFunction(scene, on_progress, &monitor);
  rtcCommitScene(scene);
  rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_CANCELLED || !progress(last)) throw cancelled();
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(GRADUS_ERROR_OUT_OF_MEMORY, "out of memory while building the acceleration structure");
  if (error != RTC_ERROR_NONE)
    throw Error(GRADUS_ERROR_UNKNOWN, "Embree failed with code " + std::to_string(int(error)));
}

// Adds the triangles of a mesh to a scene. `positions` holds all vertices of the first key, then of the next.
void attach_triangles(RTCDevice device, RTCScene scene, unsigned id, unsigned mask, const MeshData& mesh,
                      const Vec3* positions, unsigned keys) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryTimeStepCount(geometry, keys);
  for (unsigned k = 0; k < keys; ++k)
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, k, RTC_FORMAT_FLOAT3, positions,
                               k * mesh.vertex_count * sizeof(Vec3), sizeof(Vec3), mesh.vertex_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangle_vertices.data(), 0,
                             3 * sizeof(uint32_t), mesh.triangle_count);
  rtcSetGeometryMask(geometry, mask);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

// Adds a reference to the scene of a mesh, with the instance's matrix or matrix keys.
void attach_instance(RTCDevice device, RTCScene scene, unsigned id, unsigned mask, RTCScene instanced,
                     const InstanceData& instance) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, instanced);
  const std::span<const Mat4> keys =
      instance.keys ? std::span(instance.keys->keys()) : std::span(&instance.to_world, 1);
  rtcSetGeometryTimeStepCount(geometry, unsigned(keys.size()));
  for (unsigned i = 0; i < keys.size(); ++i)
    rtcSetGeometryTransform(geometry, i, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &keys[i][0][0]);
  rtcSetGeometryMask(geometry, mask);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

// Builds the scene of one mesh in its own space. The progress stays at `at`.
std::shared_ptr<const MeshScene> build_mesh_scene(const EmbreeDevice& device,
                                                  const std::shared_ptr<const MeshData>& mesh,
                                                  const BuildProgress& progress, float at) {
  auto built = std::make_shared<MeshScene>();
  built->device = device;
  built->mesh = mesh;
  built->scene = rtcNewScene(device.get());
  const bool deforms = mesh->shutter_keys > 0;
  attach_triangles(device.get(), built->scene, 0, 0xffffffffu, *mesh,
                   deforms ? mesh->shutter_positions.data() : mesh->frame_positions(),
                   deforms ? mesh->shutter_keys : 1);
  commit_scene(device.get(), built->scene, progress, at, at);
  if (!deforms)
    built->records =
        std::make_shared<TriangleRecords>(make_triangle_records(*mesh, mesh->frame_positions(), Mat3(1.0f)));
  return built;
}

// Returns the vertices of a mesh transformed by `m`, and one element of padding, because Embree reads 16 bytes at a
// time. The arithmetic is in double, because a mesh may lie far from its own origin and its matrix may move it back.
std::unique_ptr<std::vector<Vec3>> transform_positions(const MeshData& mesh, const glm::dmat4& m) {
  auto out = std::make_unique<std::vector<Vec3>>(size_t(mesh.vertex_count) + 1);
  const Vec3* in = mesh.frame_positions();
  tbb::parallel_for(tbb::blocked_range<size_t>(0, mesh.vertex_count, 1 << 14),
                    [&](const tbb::blocked_range<size_t>& range) {
                      for (size_t i = range.begin(); i < range.end(); ++i)
                        (*out)[i] = Vec3(m * glm::dvec4(glm::dvec3(in[i]), 1.0));
                    });
  return out;
}

// Returns the bounds of a scene over the time that the shutter is open.
RayBox bounds_of(RTCScene scene) {
  RTCLinearBounds bounds;
  rtcGetSceneLinearBounds(scene, &bounds);
  RayBox box;
  for (const RTCBounds& b : {bounds.bounds0, bounds.bounds1})
    box.add(Vec3(b.lower_x, b.lower_y, b.lower_z), Vec3(b.upper_x, b.upper_y, b.upper_z));
  box.widen();
  return box;
}

// Builds one GeometryGroup. Mesh scenes are taken from `known`, and new ones are added to it.
class GroupBuild {
 public:
  GroupBuild(const EmbreeDevice& device, uint64_t key, const BuildProgress& progress, MeshScenes* known)
      : device_(device), progress_(progress), known_(*known) {
    group_->device = device;
    group_->key = key;
    group_->scene = rtcNewScene(device.get());
  }

  std::shared_ptr<const GeometryGroup> run(const GroupInput& input) {
    constexpr float kMeshShare = 0.4f;  // share of the meshes in the progress
    for (size_t i = 0; i < input.members.size(); ++i) {
      const GroupInput::Member& member = input.members[i];
      const float done = kMeshShare * float(i) / float(input.members.size());
      if ((i & 255) == 0 && !progress_(done)) throw cancelled();
      if (member.flat)
        add_flat(input.instance(member), (*input.to_internal)(member.instance), unsigned(i), member.mask);
      else
        add_instance(input.instance(member), unsigned(i), member.mask, done);
    }
    commit_scene(device_.get(), group_->scene, progress_, kMeshShare, 1.0f);
    group_->box = bounds_of(group_->scene);
    return group_;
  }

 private:
  void add_flat(const InstanceData& instance, const glm::dmat4& to_internal, unsigned id, unsigned mask) {
    const MeshData& mesh = *instance.mesh;
    group_->meshes.push_back(instance.mesh);
    group_->flat_positions.push_back(transform_positions(mesh, to_internal));
    const Vec3* positions = group_->flat_positions.back()->data();
    attach_triangles(device_.get(), group_->scene, id, mask, mesh, positions, 1);
    auto records = std::make_shared<TriangleRecords>(make_triangle_records(mesh, positions, instance.normal_to_world));
    records->is_in_internal_space = true;
    group_->records.push_back(std::move(records));
  }
  void add_instance(const InstanceData& instance, unsigned id, unsigned mask, float done) {
    std::shared_ptr<const MeshScene>& scene = known_[instance.mesh.get()];
    if (!scene) scene = build_mesh_scene(device_, instance.mesh, progress_, done);
    if (used_.insert(instance.mesh.get()).second) group_->mesh_scenes.push_back(scene);
    attach_instance(device_.get(), group_->scene, id, mask, scene->scene, instance);
    group_->records.push_back(scene->records);
  }

  const EmbreeDevice& device_;
  const BuildProgress& progress_;
  MeshScenes& known_;
  std::unordered_set<const MeshData*> used_;
  std::shared_ptr<GeometryGroup> group_ = std::make_shared<GeometryGroup>();
};

}  // namespace

MeshScene::~MeshScene() {
  if (scene) rtcReleaseScene(scene);
}

GeometryGroup::~GeometryGroup() {
  if (scene) rtcReleaseScene(scene);
}

uint64_t GroupInput::key() const {
  ContentHash hash;
  for (const Member& member : members) {
    hash.value(instance(member).mesh->content_hash);
    hash.value(member.mask);
    hash.value(uint32_t(member.flat));
    if (member.flat) {
      const glm::dmat4 matrix = (*to_internal)(member.instance);
      hash.bytes(&matrix, sizeof(matrix));
    } else {
      hash.bytes(&instance(member).to_world, sizeof(Mat4));
    }
    if (instance(member).keys) hash.array(instance(member).keys->keys());
  }
  return hash.result();
}

std::shared_ptr<const GeometryGroup> build_group(const EmbreeDevice& device, const GroupInput& input, uint64_t key,
                                                 const BuildProgress& progress, MeshScenes* known) {
  return GroupBuild(device, key, progress, known).run(input);
}

}  // namespace gradus::geometry
