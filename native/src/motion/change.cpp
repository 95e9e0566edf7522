#include "motion/change.h"

#include <algorithm>

#include "geometry/mesh.h"
#include "motion/snapshot_motion.h"

namespace gradus::motion {

namespace {

bool same_view(const GradusCamera& a, const GradusCamera& b) {
  return std::equal(a.matrix, a.matrix + 16, b.matrix) && std::equal(a.window, a.window + 4, b.window);
}

// An instance with the snapshot that contains it.
struct Placed {
  const scene::Snapshot& snapshot;
  const geometry::InstanceData& instance;

  uint32_t kind() const { return instance.visibility | GRADUS_MAY_MOVE; }
  size_t slots() const { return instance.materials.size(); }
  // Returns the material of a slot, or nullptr for the default material, of which every snapshot has its own copy.
  const shading::MaterialData* material(size_t slot) const {
    const uint32_t material = instance.materials[slot];
    return material > 0 ? snapshot.materials[material].get() : nullptr;
  }
};

bool same_materials(const Placed& a, const Placed& b) {
  bool same = a.slots() == b.slots();
  for (size_t slot = 0; same && slot < a.slots(); ++slot) same = a.material(slot) == b.material(slot);
  return same;
}

// Whether an instance is the same in two snapshots.
bool is_static(const Placed& a, const Placed& b) {
  return a.instance.mesh == b.instance.mesh && a.instance.to_world == b.instance.to_world && !a.instance.moves() &&
         a.kind() == b.kind() && same_materials(a, b);
}

}  // namespace

// A camera that moves while the shutter is open has no single position in the frame, so everything counts as changed.
// An instance that moves while the shutter is open is never static, for the same reason.
Change::Change(const scene::Snapshot& now)
    : now_(now), all_(now.camera.shutter_key_count > 0), instances_(now.instances.size()) {}

void Change::add(const scene::Snapshot& other) {
  all_ |= !same_view(now_.camera, other.camera) || now_.origin != other.origin || now_.images != other.images;
  const std::vector<uint32_t> there = matching_instances(now_, other);
  std::vector<bool> is_new(other.instances.size(), true);
  for (size_t i = 0; i < instances_.size(); ++i) {
    const geometry::InstanceData &a = now_.instances[i],
                                 *b = there[i] != kNoInstance ? &other.instances[there[i]] : nullptr;
    if (b != nullptr) is_new[there[i]] = false;
    if (b != nullptr && motion::is_static({now_, a}, {other, *b})) continue;
    instances_[i] = any_ = true;
    add_box(a);
    if (b != nullptr) add_box(*b);
  }
  for (size_t i = 0; i < is_new.size(); ++i) {
    if (!is_new[i]) continue;
    any_ = true;
    add_box(other.instances[i]);
  }
  box_.widen();
}

void Change::add_box(const geometry::InstanceData& instance) {
  const geometry::MeshData& mesh = *instance.mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 local((corner & 1 ? mesh.upper : mesh.lower).x, (corner & 2 ? mesh.upper : mesh.lower).y,
                     (corner & 4 ? mesh.upper : mesh.lower).z);
    const auto point = Vec3(instance.to_world * Vec4(local, 1.0f));
    box_.add(point, point);
  }
}

}  // namespace gradus::motion
