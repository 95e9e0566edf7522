#include "scene/moved_snapshot.h"

#include <algorithm>
#include <map>

#include "scene/mesh_at.h"
#include "scene/snapshot_geometry.h"
#include "scene/tangent_field.h"

namespace gradus {

namespace {

using Meshes = std::map<const MeshData*, std::shared_ptr<const MeshData>>;

float frames_until(Moment when) { return when == Moment::Next ? 1.0f : -1.0f; }

std::shared_ptr<const MeshData> moved_mesh(const std::shared_ptr<const MeshData>& mesh, float frames, Meshes* known) {
  if (mesh->key_times.size() < 2 && mesh->shutter_keys == 0) return mesh;
  auto& moved = (*known)[mesh.get()];
  if (!moved) moved = mesh_at(*mesh, frames);
  return moved;
}

// True: it is not what it was.
bool move_instance(Moment when, Meshes* meshes, InstanceData* instance) {
  const Mat4 matrix = when == Moment::Next ? instance->to_world_next : instance->to_world_previous;
  const auto mesh = moved_mesh(instance->mesh, frames_until(when), meshes);
  if (mesh == instance->mesh && matrix == instance->to_world && !instance->moves()) return false;
  static_cast<Placement&>(*instance) = make_placement(glm::dmat4(matrix));
  instance->mirrored = glm::determinant(glm::dmat3(matrix)) < 0.0;
  instance->keys = nullptr;
  instance->deforms = false;
  instance->visibility |= GRADUS_MAY_MOVE;  // built apart from what rests, which is shared
  if (mesh != instance->mesh) instance->tangents.clear();
  instance->mesh = mesh;
  return true;
}

bool move_instances(Moment when, Snapshot* snapshot) {
  Meshes meshes;
  bool moved = false;
  for (InstanceData& instance : snapshot->instances) moved |= move_instance(when, &meshes, &instance);
  return moved;
}

void move_camera(Moment when, GradusCamera* camera) {
  const bool next = when == Moment::Next;
  std::copy_n(next ? camera->matrix_next : camera->matrix_previous, 16, camera->matrix);
  std::copy_n(next ? camera->window_next : camera->window_previous, 4, camera->window);
  camera->shutter_key_count = 0;
  camera->shutter_matrices = camera->shutter_windows = nullptr;
}

}  // namespace

std::shared_ptr<const Snapshot> moved_snapshot(const Snapshot& snapshot, Moment when, const CancelTest& is_cancelled) {
  auto moved = std::make_shared<Snapshot>(snapshot);
  moved->features.has_motion = false;
  move_camera(when, &moved->camera);
  if (!move_instances(when, moved.get())) return moved;
  add_tangents(&snapshot, moved.get());
  const auto exact = [&](size_t i) { return glm::dmat4(moved->instances[i].to_world); };
  const std::shared_ptr<Device>& device = snapshot.accelerator->resting.group->device;
  build_geometry(
      device, exact, [&](float) { return !is_cancelled(); }, snapshot.accelerator, moved.get());
  return moved;
}

}  // namespace gradus
