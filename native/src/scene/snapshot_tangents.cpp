#include "scene/snapshot_tangents.h"

#include <algorithm>
#include <map>

#include "geometry/mesh.h"
#include "geometry/tangent_field.h"
#include "scene/snapshot.h"
#include "shading/material.h"

namespace gradus::scene {

namespace {

using Fields = std::map<const geometry::MeshAttribute*, std::shared_ptr<const geometry::TangentField>>;

// The UV maps of a mesh for which a material asks.
template <class Visit>
void for_each_wanted(const Snapshot& snapshot, const geometry::InstanceData& instance, const Visit& visit) {
  const auto of_material = [&](uint32_t material) {
    for (const std::string& name : snapshot.materials[material]->tangent_maps) {
      const geometry::MeshAttribute* uv =
          name.empty() ? geometry::default_uv_map(*instance.mesh) : geometry::find_attribute(*instance.mesh, name);
      if (uv) visit(*uv);
    }
  };
  if (instance.materials.empty()) of_material(0);
  for (const uint32_t material : instance.materials) of_material(material);
}

}  // namespace

void add_tangents(const Snapshot* before, Snapshot* snapshot) {
  Fields fields;
  if (before) {
    for (const geometry::InstanceData& instance : before->instances)
      for (const auto& field : instance.tangents) fields[field->uv] = field;
  }
  for (geometry::InstanceData& instance : snapshot->instances) {
    for_each_wanted(*snapshot, instance, [&](const geometry::MeshAttribute& uv) {
      auto& field = fields[&uv];
      if (!field) field = geometry::make_tangents(instance.mesh, uv);
      if (std::find(instance.tangents.begin(), instance.tangents.end(), field) == instance.tangents.end())
        instance.tangents.push_back(field);
    });
  }
}

}  // namespace gradus::scene
