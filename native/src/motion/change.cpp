#include "motion/change.h"

#include <algorithm>

#include "scene/mesh.h"

namespace gradus {

namespace {

bool same_view(const GradusCamera& a, const GradusCamera& b) {
  return std::equal(a.matrix, a.matrix + 16, b.matrix) && std::equal(a.window, a.window + 4, b.window);
}

}  // namespace

// A camera or an object that moves within the frame is elsewhere at each of its moments.
Change::Change(const Snapshot& now) : now_(now), camera_(now.camera.shutter_key_count > 0), instances_(now.instances.size()) {}

void Change::add(const Snapshot& other) {
  camera_ |= !same_view(now_.camera, other.camera);
  for (size_t i = 0; i < instances_.size(); ++i) {
    const InstanceData &a = now_.instances[i], &b = other.instances[i];
    if (a.mesh == b.mesh && a.to_world == b.to_world && !a.moves()) continue;
    instances_[i] = any_ = true;
    add_box(a);
    add_box(b);
  }
  box_.widen();
}

void Change::add_box(const InstanceData& instance) {
  const MeshData& mesh = *instance.mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 local((corner & 1 ? mesh.upper : mesh.lower).x, (corner & 2 ? mesh.upper : mesh.lower).y,
                     (corner & 4 ? mesh.upper : mesh.lower).z);
    const auto point = Vec3(instance.to_world * Vec4(local, 1.0f));
    box_.add(point, point);
  }
}

}  // namespace gradus
