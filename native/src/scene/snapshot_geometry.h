// Builds the parts of a snapshot that depend on both its instances and their materials: the acceleration structure and
// the tangents.
#pragma once

#include <memory>

#include "base/commit_monitor.h"
#include "geometry/accelerator.h"
#include "scene/snapshot.h"

namespace gradus::scene {

// Builds the acceleration structure, and sets the instances' flat triangles and has_transparent_shadows. `before` is
// the structure of another snapshot, whose parts are reused if they are equal, or nullptr. Throws Error CANCELLED or
// OUT_OF_MEMORY.
void build_geometry(const geometry::EmbreeDevice& device, const geometry::ExactMatrices& to_internal,
                    const BuildProgress& progress, const std::shared_ptr<const geometry::Accelerator>& before,
                    Snapshot* snapshot);

// Computes the tangents that the materials of the instances read. Those that `before` already has are shared. Throws
// Error CANCELLED.
void add_tangents(const Snapshot* before, const CommitMonitor& monitor, Snapshot* snapshot);
// Computes those of a single instance.
void add_tangents(const Snapshot& snapshot, const CommitMonitor& monitor, geometry::InstanceData* instance);

}  // namespace gradus::scene
