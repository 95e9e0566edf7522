// Motion of components for the passes Path <Component> Motion and Path <Component> Tracked.
#pragma once

#include <vector>

#include "motion/specular_motion.h"

namespace gradus::motion {

// Motion of a component, one value for each pixel of a region.
struct ComponentMotion {
  std::vector<Vec4> vectors;   // (previous − now, now − next) in pixels, y up; 0 unless both frames are tracked
  std::vector<float> tracked;  // a Tracking: 1, or the cause why the previous or else the next frame is not tracked
  std::vector<film::ShownPoint> shown;
  TrackingCounts counts;
};

// Returns the motion of the components whose bits are set in `wanted`, in order. It holds for the middle of the lens
// and the time of the frame. The neighbouring frames are given by the vector keys of the snapshot. Residual has no
// representative path; its motion is that of the surfaces that the camera sees. Throws Error CANCELLED or
// OUT_OF_MEMORY.
std::vector<ComponentMotion> component_motion(
    const scene::Snapshot& snapshot, const GradusSettings& settings, const lpe::ComponentSet& components,
    uint32_t wanted, const Region& region, const CancelCheck& is_cancelled = [] { return false; });

}  // namespace gradus::motion
