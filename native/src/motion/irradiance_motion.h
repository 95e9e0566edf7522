// Motion of light that does not move with surfaces: shadows, reflections on rough surfaces, and all light without a
// representative path. It is estimated from two frames of a component, by optical flow relative to the motion of
// surfaces (Zimmer et al. 2015, section 4.2).
#pragma once

#include <array>

#include "motion/flow_levels.h"
#include "motion/tracking.h"

namespace gradus::motion {

// A component in one frame: one value for each pixel of the film, row by row.
struct ComponentFrame {
  std::span<const Rgb> radiance;    // radiance or irradiance
  std::span<const Vec2> surface;    // motion of the surface to the other frame, in pixels, y with the rows
  std::span<const float> tracked;   // kTracked if that motion is known, otherwise a cause (motion/tracking.h)
  std::span<const int32_t> object;  // number of the object; may be empty
  std::span<const float> depth;     // 0 where there is no surface; may be empty
};

// Motion to the other frame, one value for each pixel.
struct PixelMotion {
  std::vector<Vec2> vectors;   // in pixels, y with the rows; the motion of the surface where not tracked
  std::vector<float> tracked;  // kTracked or a cause (motion/tracking.h)
};

// Returns the motion from the first frame to the second, and from the second to the first. Vectors are finite and no
// longer than the film for any input. Without a library, vectors are those of surfaces and no pixel is tracked. Throws
// as optical_flow() does.
std::array<PixelMotion, 2> irradiance_motion(const FlowLibrary* library, int width, int height,
                                             const ComponentFrame& first, const ComponentFrame& second,
                                             FlowDomain domain);

}  // namespace gradus::motion
