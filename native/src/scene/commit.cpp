// Scene::commit: from what was set to an immutable snapshot.
#include <algorithm>
#include <atomic>

#include "base/device.h"
#include "base/error.h"
#include "base/fpu.h"
#include "scene/scene_state.h"

namespace gradus {

namespace {

using MaterialIndex = std::unordered_map<uint64_t, uint32_t>;

uint32_t index_of(const MaterialIndex& indices, uint64_t key) {
  const auto found = indices.find(key);
  return found == indices.end() ? 0 : found->second;
}

void assign_materials(const InstanceArrays& arrays, const std::vector<size_t>& chosen, const MaterialIndex& indices, Snapshot* snapshot) {
  if (arrays.material_first.empty()) return;
  for (size_t k = 0; k < chosen.size(); ++k) {
    const uint64_t* keys = arrays.materials.data() + arrays.material_first[chosen[k]];
    auto& slots = snapshot->instances[k].materials;
    slots.resize(arrays.material_count[chosen[k]]);
    for (size_t s = 0; s < slots.size(); ++s) slots[s] = index_of(indices, keys[s]);
  }
}

uint32_t embree_mask(const InstanceData& instance, bool transparent) {
  uint32_t mask = instance.visibility & kMaskVisibility;
  if (mask & GRADUS_VISIBLE_SHADOW) mask |= transparent ? kMaskTransparentShadow : kMaskOpaqueShadow;
  return mask;
}

void move_matrix(float* matrix, const Vec3& origin) {
  for (int i = 0; i < 3; ++i) matrix[12 + i] = float(double(matrix[12 + i]) - double(origin[i]));
}

GradusCamera moved_camera(GradusCamera camera, const Vec3& origin) {
  move_matrix(camera.matrix, origin);
  move_matrix(camera.matrix_previous, origin);
  move_matrix(camera.matrix_next, origin);
  return camera;
}

void build_geometry(const std::shared_ptr<Device>& device, const std::vector<size_t>& chosen, const BuildProgress& progress,
                    Scene::State* state, Snapshot* snapshot) {
  std::vector<uint32_t> masks(chosen.size());
  for (size_t k = 0; k < chosen.size(); ++k) masks[k] = embree_mask(snapshot->instances[k], false);
  const auto exact = [&](size_t k) { return internal_matrix(state->instances.matrices[chosen[k]], snapshot->origin); };
  snapshot->accelerator = build_accelerator(device, {&snapshot->instances, &masks, exact}, progress, &state->mesh_scenes);
}

}  // namespace

void CommitMonitor::check() const {
  if (!go_on()) throw cancelled();
}

void CommitMonitor::report(float fraction) const {
  if (!progress_) return;
  std::atomic_ref<float> shared(*progress_);
  // Embree reports from several threads: never let it fall.
  float before = shared.load();
  while (before < fraction && !shared.compare_exchange_weak(before, fraction)) continue;
}

BuildProgress CommitMonitor::step(float first, float last) const {
  return [this, first, last](float fraction) {
    report(first + (last - first) * std::clamp(fraction, 0.0f, 1.0f));
    return go_on();
  };
}

void Scene::commit(const volatile int32_t* cancel, float* progress) {
  if (progress) *progress = 0.0f;
  const std::lock_guard<std::mutex> lock(state_->mutex);
  const CommitMonitor monitor(cancel, progress);
  monitor.check();
  auto snapshot = std::make_shared<Snapshot>();
  device_->arena().execute([&] {
    const FlushDenormals flush;
    const std::vector<size_t> chosen = place_instances(*state_, snapshot.get());
    assign_materials(state_->instances, chosen, {}, snapshot.get());
    build_geometry(device_, chosen, monitor.step(0.0f, 0.9f), state_.get(), snapshot.get());
    if (state_->has_camera) snapshot->camera = moved_camera(state_->camera, snapshot->origin);
    snapshot->has_camera = state_->has_camera;
    snapshot->world = state_->world;
  });
  for (const std::string& text : snapshot->warnings) device_->warn(text);
  monitor.report(1.0f);
  state_->current = std::move(snapshot);
}

}  // namespace gradus
