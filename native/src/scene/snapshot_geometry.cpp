#include "scene/snapshot_geometry.h"

#include <algorithm>

#include "shading/material.h"

namespace gradus::scene {

namespace {

template <class Test>
bool any_material(const Snapshot& snapshot, const geometry::InstanceData& instance, Test&& test) {
  if (instance.materials.empty()) return test(*snapshot.materials[0]);
  return std::any_of(instance.materials.begin(), instance.materials.end(),
                     [&](uint32_t m) { return test(*snapshot.materials[m]); });
}

bool lets_shadows_through(const Snapshot& snapshot, const geometry::InstanceData& instance) {
  return any_material(snapshot, instance,
                      [](const shading::MaterialData& m) { return m.may_be_transparent && m.transparent_shadow; });
}

uint32_t embree_mask(const geometry::InstanceData& instance, bool transparent) {
  uint32_t mask = instance.visibility & geometry::kMaskVisibility;
  if (mask & GRADUS_VISIBLE_SHADOW)
    mask |= transparent ? geometry::kMaskTransparentShadow : geometry::kMaskOpaqueShadow;
  return mask;
}

void refer_to_triangles(const geometry::Accelerator::Part& part, Snapshot* snapshot) {
  for (size_t k = 0; k < part.instances.size(); ++k) {
    const geometry::FlatTriangles& flat = part.group->flat_triangles[k];
    snapshot->instances[part.instances[k]].flat_triangles = flat.empty() ? nullptr : flat.data();
  }
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
  refer_to_triangles(snapshot->accelerator->static_part, snapshot);
  refer_to_triangles(snapshot->accelerator->moving, snapshot);
}

}  // namespace gradus::scene
