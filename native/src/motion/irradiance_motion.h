// Motion of what surfaces do not carry along: shadows, reflections on rough surfaces, all that no path is followed for.
// From two frames of a component by optical flow about the surfaces' motion (Zimmer et al. 2015, section 4.2).
#pragma once

#include <array>

#include "motion/flow_levels.h"
#include "motion/tracking.h"

namespace gradus::motion {

// What a frame shows of a component, by pixels of the film, row by row.
struct ComponentFrame {
  std::span<const Rgb> radiance;   // or irradiance
  std::span<const Vec2> surface;   // how far away the other frame has the same point of the surface, in pixels: along a
                                   // row, from row to row
  std::span<const float> tracked;  // whether that is known: kTracked or a cause
  std::span<const int32_t> object;  // which one; may be empty
  std::span<const float> depth;     // 0: nothing is there; may be empty
};

struct PixelMotion {
  std::vector<Vec2> vectors;   // to the other frame, in pixels; where not tracked: the surface's
  std::vector<float> tracked;  // kTracked or a cause (motion/tracking.h)
};

// Of the first frame to the second, and of the second to the first. Vectors are finite and no longer than the film for
// any input. Without a library they are the surfaces', and nothing is tracked.
std::array<PixelMotion, 2> irradiance_motion(const FlowLibrary* library, int width, int height,
                                             const ComponentFrame& first, const ComponentFrame& second,
                                             FlowDomain domain);

}  // namespace gradus::motion
