#include "scene/moved_snapshot.h"

#include <algorithm>
#include <map>

#include <glm/gtc/type_ptr.hpp>

#include "base/commit_monitor.h"
#include "geometry/matrix_keys.h"
#include "geometry/mesh_at.h"
#include "scene/snapshot_geometry.h"

namespace gradus::scene {

namespace {

using Meshes = std::map<const geometry::MeshData*, std::shared_ptr<const geometry::MeshData>>;

// A step to the next or the previous frame, or a fraction of it.
struct Step {
  Moment when;
  float share;

  bool is_next() const { return when == Moment::Next; }
  float frames() const { return is_next() ? share : -share; }
  Mat4 matrix(const Mat4& now, const Mat4& then) const {
    return share == 1.0f || now == then
               ? then
               : Mat4(geometry::interpolate_motion(glm::dmat4(now), glm::dmat4(then), double(share)));
  }
};

std::shared_ptr<const geometry::MeshData> moved_mesh(const std::shared_ptr<const geometry::MeshData>& mesh,
                                                     float frames, Meshes* known) {
  if (mesh->key_times.size() < 2 && mesh->shutter_keys == 0) return mesh;
  auto& moved = (*known)[mesh.get()];
  if (!moved) moved = geometry::mesh_at(*mesh, frames);
  return moved;
}

// Moves an instance. Returns whether it changed.
bool move_instance(const Step& step, Meshes* meshes, geometry::InstanceData* instance) {
  if (!(step.is_next() ? instance->will_be_there : instance->was_there)) {
    instance->id = geometry::kNobody;
    instance->visibility = GRADUS_MAY_MOVE;
    return true;
  }
  const Mat4 matrix =
      step.matrix(instance->to_world, step.is_next() ? instance->to_world_next : instance->to_world_previous);
  const auto mesh = moved_mesh(instance->mesh, step.frames(), meshes);
  if (mesh == instance->mesh && matrix == instance->to_world && !instance->moves()) return false;
  static_cast<geometry::Placement&>(*instance) = geometry::make_placement(glm::dmat4(matrix));
  instance->mirrored = glm::determinant(glm::dmat3(matrix)) < 0.0;
  instance->keys = nullptr;
  instance->deforms = false;
  instance->visibility |= GRADUS_MAY_MOVE;  // excludes it from the shared static group
  if (mesh != instance->mesh) instance->tangents.clear();
  instance->mesh = mesh;
  return true;
}

// Moves the surface of an instance before its displacement, from which bumps start.
void move_undisplaced(const Step& step, const Snapshot& snapshot, Meshes* meshes, geometry::InstanceData* instance) {
  if (!instance->undisplaced) return;
  auto undisplaced = std::make_shared<geometry::InstanceData>(*instance->undisplaced);
  move_instance(step, meshes, undisplaced.get());
  if (undisplaced->tangents.empty()) add_tangents(snapshot, CommitMonitor(nullptr, nullptr), undisplaced.get());
  instance->undisplaced = std::move(undisplaced);
}

bool move_instances(const Step& step, Snapshot* snapshot) {
  Meshes meshes;
  bool moved = false;
  for (geometry::InstanceData& instance : snapshot->instances) {
    if (!move_instance(step, &meshes, &instance)) continue;
    move_undisplaced(step, *snapshot, &meshes, &instance);
    moved = true;
  }
  return moved;
}

void move_camera(const Step& step, GradusCamera* camera) {
  const Mat4 then = glm::make_mat4(step.is_next() ? camera->matrix_next : camera->matrix_previous);
  const Mat4 matrix = step.matrix(glm::make_mat4(camera->matrix), then);
  std::copy_n(glm::value_ptr(matrix), 16, camera->matrix);
  const float* window = step.is_next() ? camera->window_next : camera->window_previous;
  for (int i = 0; i < 4; ++i)
    camera->window[i] =
        step.share == 1.0f ? window[i] : camera->window[i] + step.share * (window[i] - camera->window[i]);
  camera->shutter_key_count = 0;
  camera->shutter_matrices = camera->shutter_windows = nullptr;
}

}  // namespace

std::shared_ptr<const Snapshot> moved_snapshot(const Snapshot& snapshot, Moment when, const CancelCheck& is_cancelled,
                                               float share) {
  const Step step{when, share};
  auto moved = std::make_shared<Snapshot>(snapshot);
  moved->features.has_motion = false;
  moved->is_other_shot = step.is_next() ? snapshot.shot_change_after : snapshot.shot_change_before;
  move_camera(step, &moved->camera);
  if (!move_instances(step, moved.get())) return moved;
  add_tangents(&snapshot, CommitMonitor(nullptr, nullptr), moved.get());
  const auto exact = [&](size_t i) { return glm::dmat4(moved->instances[i].to_world); };
  const geometry::EmbreeDevice& device = snapshot.accelerator->static_part.group->device;
  build_geometry(
      device, exact, [&](float) { return !is_cancelled(); }, snapshot.accelerator, moved.get());
  return moved;
}

}  // namespace gradus::scene
