// What rays of a snapshot meet: a group of instances that rest from frame to frame, built once and shared by all
// snapshots in which it is the same, and beside it a group of those that move.
#pragma once

#include <memory>
#include <vector>

#include "base/types.h"
#include "geometry/geometry.h"
#include "geometry/geometry_group.h"

namespace gradus::geometry {

// Bits of Embree's ray masks beside GradusVisibility's.
inline constexpr uint32_t kMaskVisibility = GRADUS_VISIBLE_ALL;
inline constexpr uint32_t kMaskOpaqueShadow = 1u << 8;       // casts shadows, all of its materials opaque for them
inline constexpr uint32_t kMaskTransparentShadow = 1u << 9;  // casts shadows that a material may let through

struct Accelerator {
  struct Part {
    std::shared_ptr<const GeometryGroup> group;
    std::vector<uint32_t> instances;  // of the snapshot, for each member of the group
  };
  Part static_part;
  Part moving;  // without a group where nothing moves, or where it would not pay
};

struct AcceleratorInput {
  const std::vector<InstanceData>* instances;
  const std::vector<uint32_t>* masks;  // Embree mask of each instance
  ExactMatrices to_internal;
};

// before: of the last snapshot, or nullptr; what is the same is taken from it, and it is given back if nothing changed.
// Throws Error CANCELLED or OUT_OF_MEMORY. The instances' flat_triangles are left to the caller.
std::shared_ptr<const Accelerator> build_accelerator(const EmbreeDevice& device, const AcceleratorInput& input,
                                                     const BuildProgress& progress,
                                                     const std::shared_ptr<const Accelerator>& before);

// Queries with a mask of the bits above. Rays that are not finite miss.
bool trace_nearest(const Accelerator& accelerator, const Ray& ray, uint32_t mask, Hit* hit);
bool trace_any(const Accelerator& accelerator, const Ray& ray, uint32_t mask);

}  // namespace gradus::geometry
