// Builds the acceleration structure of a snapshot from its instances and their materials.
#pragma once

#include <memory>

#include "geometry/accelerator.h"
#include "scene/snapshot.h"

namespace gradus::scene {

// Fills accelerator, the instances' flat triangles and has_transparent_shadows. before: of another snapshot, or
// nullptr. Throws Error CANCELLED or OUT_OF_MEMORY.
void build_geometry(const geometry::EmbreeDevice& device, const geometry::ExactMatrices& to_internal,
                    const BuildProgress& progress, const std::shared_ptr<const geometry::Accelerator>& before,
                    Snapshot* snapshot);

}  // namespace gradus::scene
