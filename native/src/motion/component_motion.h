// Motion of components for passes: Path <Component> Motion and Path <Component> Tracked (contract 6.6).
#pragma once

#include <vector>

#include "motion/specular_motion.h"

namespace gradus::motion {

// By pixels of a region.
struct ComponentMotion {
  std::vector<Vec4> vectors;   // previous − now, now − next: pixels, y up; 0 where it is not tracked to both
  std::vector<float> tracked;  // a Tracking: 1, or the cause of the first that failed
  std::vector<film::ShownPoint> shown;
  TrackingCounts counts;
};

// Of the components whose bit is set in `wanted`, in order, by the vector keys that the snapshot holds, for the middle
// of the lens and the moment of the frame. No path stands for Residual: in its place are the surfaces that the camera
// sees. Throws Error CANCELLED or OUT_OF_MEMORY.
std::vector<ComponentMotion> component_motion(
    const scene::Snapshot& snapshot, const GradusSettings& settings, const lpe::ComponentSet& components,
    uint32_t wanted, const Region& region, const CancelCheck& is_cancelled = [] { return false; });

}  // namespace gradus::motion
