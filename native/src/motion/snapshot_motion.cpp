#include "motion/snapshot_motion.h"

#include <unordered_map>

#include "base/fault.h"
#include "geometry/dicing_tree.h"
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

namespace {

// Returns whether two meshes are dicings of meshes with the same triangles.
bool are_dicings_of_one(const geometry::MeshData& a, const geometry::MeshData& b) {
  return a.dicing && b.dicing && a.dicing->topology_hash == b.dicing->topology_hash;
}

}  // namespace

SnapshotMotion::SnapshotMotion(const scene::Snapshot& from, const scene::Snapshot& to)
    : from_(from), to_(to), instance_(matching_instances(from, to)) {
  is_diced_anew_.assign(instance_.size(), false);
  for (size_t i = 0; i < instance_.size(); ++i) {
    if (instance_[i] == kNoInstance) continue;
    const geometry::MeshData& before = *from.instances[i].mesh;
    const geometry::MeshData& after = *to.instances[instance_[i]].mesh;
    if (before.topology_hash == after.topology_hash || GRADUS_FAULT(changed_mesh_taken_for_same)) continue;
    is_diced_anew_[i] = are_dicings_of_one(before, after);
    if (!is_diced_anew_[i]) instance_[i] = kNoInstance;
  }
}

bool SnapshotMotion::hit(const geometry::Hit& hit, geometry::Hit* there) const {
  *there = hit;
  there->instance = instance_[hit.instance];
  there->time = to_.shutter.time_of_frame();
  if (!there->valid()) return false;
  if (is_diced_anew_[hit.instance]) {
    const geometry::DicingTree& before = *from_.instances[hit.instance].mesh->dicing;
    const geometry::DicingTree& after = *to_.instances[there->instance].mesh->dicing;
    const geometry::TrianglePoint point = after.from_base(before.to_base({hit.primitive, hit.uv}));
    there->primitive = point.triangle;
    there->uv = point.uv;
  }
  return true;
}

bool SnapshotMotion::position(const geometry::Hit& hit, Vec3* position) const {
  geometry::Hit there;
  if (!this->hit(hit, &there)) return false;
  *position = to_.position(there);
  return true;
}

}  // namespace gradus::motion
