#include "motion/snapshot_motion.h"

#include <unordered_map>

#include "base/fault.h"
#include "geometry/mesh.h"

namespace gradus::motion {

std::vector<uint32_t> matching_instances(const scene::Snapshot& from, const scene::Snapshot& to) {
  std::unordered_map<uint64_t, uint32_t> by_id;
  for (uint32_t i = 0; i < to.instances.size(); ++i) by_id.emplace(to.instances[i].id, i);
  std::vector<uint32_t> matches;
  matches.reserve(from.instances.size());
  for (const geometry::InstanceData& instance : from.instances) {
    const auto found = instance.id != geometry::kNobody ? by_id.find(instance.id) : by_id.end();
    matches.push_back(found != by_id.end() ? found->second : kNoInstance);
    if (GRADUS_FAULT(objects_matched_by_index))
      matches.back() = uint32_t(std::min(matches.size(), to.instances.size()) - 1);
  }
  return matches;
}

SnapshotMotion::SnapshotMotion(const scene::Snapshot& from, const scene::Snapshot& to)
    : to_(to), instance_(matching_instances(from, to)) {
  for (size_t i = 0; i < instance_.size(); ++i) {
    if (instance_[i] == kNoInstance) continue;
    if (from.instances[i].mesh->topology_hash != to.instances[instance_[i]].mesh->topology_hash &&
        !GRADUS_FAULT(changed_mesh_taken_for_same))
      instance_[i] = kNoInstance;
  }
}

bool SnapshotMotion::hit(const geometry::Hit& hit, geometry::Hit* there) const {
  *there = hit;
  there->instance = instance_[hit.instance];
  there->time = to_.shutter.time_of_frame();
  return there->valid();
}

bool SnapshotMotion::position(const geometry::Hit& hit, Vec3* position) const {
  geometry::Hit there;
  if (!this->hit(hit, &there)) return false;
  *position = to_.position(there);
  return true;
}

}  // namespace gradus::motion
