// The acceleration structure of a snapshot. It has a group of instances that are the same from frame to frame, and a
// group of moving instances. The static group is built once and shared by all snapshots in which it is unchanged.
#pragma once

#include <memory>
#include <vector>

#include "base/types.h"
#include "geometry/geometry.h"
#include "geometry/geometry_group.h"

namespace gradus::geometry {

// Bits of Embree's ray masks: those of GradusVisibility, and two for shadow rays.
inline constexpr uint32_t kMaskVisibility = GRADUS_VISIBLE_ALL;
inline constexpr uint32_t kMaskOpaqueShadow = 1u << 8;       // casts shadows; all materials are opaque
inline constexpr uint32_t kMaskTransparentShadow = 1u << 9;  // casts shadows; a material may be transparent

struct Accelerator {
  // A group, and the mapping from its members to the snapshot's instances.
  struct Part {
    std::shared_ptr<const GeometryGroup> group;
    std::vector<uint32_t> instances;  // index in Snapshot::instances of each member of the group
  };
  Part static_part;
  Part moving;  // group is nullptr if nothing moves, or if a separate group would not pay
};

struct AcceleratorInput {
  const std::vector<InstanceData>* instances;
  const std::vector<uint32_t>* masks;  // Embree mask of each instance
  ExactMatrices to_internal;           // matrix of each instance to internal space
};

// Builds the acceleration structure of the given instances. `before` is the accelerator of the previous snapshot or
// nullptr: unchanged groups are taken from it, and it is returned itself if nothing changed. The caller must set the
// instances' records afterwards. Throws Error CANCELLED or OUT_OF_MEMORY.
std::shared_ptr<const Accelerator> build_accelerator(const EmbreeDevice& device, const AcceleratorInput& input,
                                                     const BuildProgress& progress,
                                                     const std::shared_ptr<const Accelerator>& before);

// Finds the nearest hit of a ray among the instances that share a bit with `mask`. Returns false, and an invalid hit,
// if there is none. Rays that are not finite miss.
bool trace_nearest(const Accelerator& accelerator, const Ray& ray, uint32_t mask, Hit* hit);
// Finds the nearest hit of a ray with one instance. Returns false, and an invalid hit, if there is none.
bool trace_instance(const Accelerator& accelerator, const Ray& ray, uint32_t instance, Hit* hit);
// Returns whether a ray hits any instance that shares a bit with `mask`. Rays that are not finite miss.
bool trace_any(const Accelerator& accelerator, const Ray& ray, uint32_t mask);

}  // namespace gradus::geometry
