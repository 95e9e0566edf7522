#include "scene/snapshot_geometry.h"

#include <algorithm>
#include <map>

#include "geometry/mesh.h"
#include "geometry/tangent_field.h"
#include "shading/material.h"

namespace gradus::scene {

namespace {

// Returns whether a material of the instance passes a test.
template <class Test>
bool any_material(const Snapshot& snapshot, const geometry::InstanceData& instance, Test&& test) {
  if (instance.materials.empty()) return test(*snapshot.materials[0]);
  return std::any_of(instance.materials.begin(), instance.materials.end(),
                     [&](uint32_t m) { return test(*snapshot.materials[m]); });
}

// Returns whether shadow rays have to evaluate materials of the instance.
bool lets_shadows_through(const Snapshot& snapshot, const geometry::InstanceData& instance) {
  return any_material(snapshot, instance,
                      [](const shading::MaterialData& m) { return m.may_be_transparent && m.transparent_shadow; });
}

// Returns the mask of an instance for Embree, which selects it for rays of some types.
uint32_t embree_mask(const geometry::InstanceData& instance, bool transparent) {
  uint32_t mask = instance.visibility & geometry::kMaskVisibility;
  if (mask & GRADUS_VISIBLE_SHADOW)
    mask |= transparent ? geometry::kMaskTransparentShadow : geometry::kMaskOpaqueShadow;
  return mask;
}

// Sets the pointers of the instances to the records of one part of the acceleration structure.
void refer_to_records(const geometry::Accelerator::Part& part, Snapshot* snapshot) {
  const auto data_of = [](const auto& values) { return values.empty() ? nullptr : values.data(); };
  for (size_t k = 0; k < part.instances.size(); ++k) {
    const geometry::TriangleRecords* records = part.group->records[k].get();
    geometry::InstanceData& instance = snapshot->instances[part.instances[k]];
    instance.triangles = records ? data_of(records->triangles) : nullptr;
    instance.normals = records ? data_of(records->normals) : nullptr;
    instance.is_in_top_level = records && records->is_in_internal_space;
  }
}

// Calls visit(uv) for every UV map of an instance whose tangents its materials read.
template <class Visit>
void for_each_tangent_map(const Snapshot& snapshot, const geometry::InstanceData& instance, const Visit& visit) {
  const auto of_material = [&](uint32_t material) {
    for (const std::string& name : snapshot.materials[material]->tangent_maps) {
      if (const geometry::MeshAttribute* uv = geometry::uv_map(*instance.mesh, name)) visit(*uv);
    }
  };
  if (instance.materials.empty()) of_material(0);
  for (const uint32_t material : instance.materials) of_material(material);
}

using TangentFields = std::map<const geometry::MeshAttribute*, std::shared_ptr<const geometry::TangentField>>;

// Adds the tangents of an instance. Those in `fields` are shared, and it receives the others.
void add_tangents_of(const Snapshot& snapshot, const CommitMonitor& monitor, TangentFields* fields,
                     geometry::InstanceData* instance) {
  for_each_tangent_map(snapshot, *instance, [&](const geometry::MeshAttribute& uv) {
    auto& field = (*fields)[&uv];
    if (!field) field = geometry::make_tangents(instance->mesh, uv, monitor);
    if (std::find(instance->tangents.begin(), instance->tangents.end(), field) == instance->tangents.end())
      instance->tangents.push_back(field);
  });
}

}  // namespace

void build_geometry(const geometry::EmbreeDevice& device, const geometry::ExactMatrices& to_internal,
                    const BuildProgress& progress, const std::shared_ptr<const geometry::Accelerator>& before,
                    Snapshot* snapshot) {
  std::vector<uint32_t> masks(snapshot->instances.size());
  for (size_t k = 0; k < masks.size(); ++k) {
    const bool transparent = lets_shadows_through(*snapshot, snapshot->instances[k]);
    masks[k] = embree_mask(snapshot->instances[k], transparent);
    snapshot->features.has_transparent_shadows |= transparent && (masks[k] & geometry::kMaskTransparentShadow);
  }
  snapshot->accelerator =
      geometry::build_accelerator(device, {&snapshot->instances, &masks, to_internal}, progress, before);
  refer_to_records(snapshot->accelerator->static_part, snapshot);
  refer_to_records(snapshot->accelerator->moving, snapshot);
}

void add_tangents(const Snapshot* before, const CommitMonitor& monitor, Snapshot* snapshot) {
  TangentFields fields;
  if (before) {
    for (const geometry::InstanceData& instance : before->instances)
      for (const auto& field : instance.tangents) fields[field->uv] = field;
  }
  for (geometry::InstanceData& instance : snapshot->instances) add_tangents_of(*snapshot, monitor, &fields, &instance);
}

void add_tangents(const Snapshot& snapshot, const CommitMonitor& monitor, geometry::InstanceData* instance) {
  TangentFields fields;
  add_tangents_of(snapshot, monitor, &fields, instance);
}

}  // namespace gradus::scene
