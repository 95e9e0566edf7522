#include "motion/snapshot_motion.h"

#include <unordered_map>

#include "scene/mesh.h"

namespace gradus {

SnapshotMotion::SnapshotMotion(const Snapshot& from, const Snapshot& to) : to_(to), instance_(from.instances.size(), UINT32_MAX) {
  std::unordered_map<uint64_t, uint32_t> by_id;
  for (uint32_t i = 0; i < to.instances.size(); ++i) by_id.emplace(to.instances[i].id, i);
  for (size_t i = 0; i < from.instances.size(); ++i) {
    const auto found = by_id.find(from.instances[i].id);
    if (found == by_id.end()) continue;
    const MeshData &a = *from.instances[i].mesh, &b = *to.instances[found->second].mesh;
    if (a.topology_hash == b.topology_hash) instance_[i] = found->second;
  }
}

bool SnapshotMotion::hit(const Hit& hit, Hit* there) const {
  *there = hit;
  there->instance = instance_[hit.instance];
  there->time = to_.shutter.time_of_frame();
  return there->valid();
}

bool SnapshotMotion::position(const Hit& hit, Vec3* position) const {
  Hit there;
  if (!this->hit(hit, &there)) return false;
  *position = interpolate(to_.corners(there.instance, there.triangle, there.time), there.barycentric);
  return true;
}

}  // namespace gradus
