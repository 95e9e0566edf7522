#include "scene/displace_instances.h"

#include <algorithm>

#include "geometry/displaced_mesh.h"
#include "geometry/mesh.h"
#include "scene/snapshot_geometry.h"
#include "shading/displacement.h"
#include "shading/material.h"

namespace gradus::scene {

namespace {

using Materials = std::vector<std::shared_ptr<const shading::MaterialData>>;

Materials materials_of(const Snapshot& snapshot, const geometry::InstanceData& instance) {
  if (instance.materials.empty()) return {snapshot.materials[0]};
  Materials materials;
  for (const uint32_t m : instance.materials) materials.push_back(snapshot.materials[m]);
  return materials;
}

bool displaces(const Snapshot& snapshot, const geometry::InstanceData& instance) {
  return std::any_of(instance.materials.begin(), instance.materials.end(),
                     [&](uint32_t m) { return snapshot.materials[m]->displaces; });
}

// Returns whether programs read the same values of both instances.
bool same_values(const geometry::InstanceData& a, const geometry::InstanceData& b) {
  return a.to_world == b.to_world && a.random_id == b.random_id && a.pass_index == b.pass_index && a.color == b.color &&
         a.generated == b.generated && a.uv == b.uv && a.attributes == b.attributes;
}

DisplacedMesh displace(const CommitMonitor& monitor, const Snapshot& snapshot, size_t index, Materials materials) {
  DisplacedMesh result;
  result.from = snapshot.instances[index];
  result.from.keys = nullptr;
  result.materials = std::move(materials);
  add_tangents(snapshot, monitor, &result.from);
  const shading::VertexOffsets found = shading::evaluate_offsets(snapshot, uint32_t(index), result.from, monitor);
  result.not_finite = found.not_finite;
  const bool moves =
      std::any_of(found.offsets.begin(), found.offsets.end(), [](const Vec3& offset) { return offset != Vec3(0.0f); });
  result.mesh =
      moves ? geometry::displaced_mesh(*result.from.mesh, found.offsets, found.moves, monitor) : result.from.mesh;
  return result;
}

// Gives an instance its displaced mesh.
void replace_mesh(const DisplacedMesh& displaced, geometry::InstanceData* instance) {
  if (displaced.mesh == instance->mesh) return;
  const bool bumps = std::any_of(displaced.materials.begin(), displaced.materials.end(),
                                 [](const auto& material) { return material->displaces && material->bumps; });
  if (bumps) {
    auto undisplaced = std::make_shared<geometry::InstanceData>(*instance);
    undisplaced->tangents = displaced.from.tangents;
    instance->undisplaced = std::move(undisplaced);
  }
  instance->mesh = displaced.mesh;
}

}  // namespace

std::vector<size_t> displace_instances(const CommitMonitor& monitor, std::vector<DisplacedMesh>* known,
                                       Snapshot* snapshot) {
  std::vector<size_t> broken;
  std::vector<DisplacedMesh> kept;
  for (size_t k = 0; k < snapshot->instances.size(); ++k) {
    geometry::InstanceData& instance = snapshot->instances[k];
    if (!displaces(*snapshot, instance)) continue;
    monitor.check();
    Materials materials = materials_of(*snapshot, instance);
    const auto is_same = [&](const DisplacedMesh& d) {
      return d.from.mesh == instance.mesh && d.materials == materials;
    };
    auto found = std::find_if(kept.begin(), kept.end(), is_same);
    if (found == kept.end()) {
      const auto old = std::find_if(known->begin(), known->end(), [&](const DisplacedMesh& d) {
        return is_same(d) && same_values(d.from, instance);
      });
      kept.push_back(old != known->end() ? *old : displace(monitor, *snapshot, k, std::move(materials)));
      found = kept.end() - 1;
    }
    if (found->not_finite > 0) broken.push_back(k);
    replace_mesh(*found, &instance);
  }
  *known = std::move(kept);
  return broken;
}

}  // namespace gradus::scene
