// Converts two frames of a component to grey images for optical flow.
#pragma once

#include <array>
#include <span>

#include "motion/optical_flow.h"

namespace gradus::motion {

enum class FlowDomain {
  Logarithmic,  // for irradiance: shadows have the same contrast at any brightness
  Linear,
};

// Returns both frames as levels from 0 to 255 on a common scale. The scale spans the values of all but 0.2 % of the
// pixels at either end, and a minimum range, so that noise alone is not stretched over the whole scale. Values that are
// not finite count as black.
std::array<GreyImage, 2> flow_levels(int width, int height, std::span<const Rgb> first, std::span<const Rgb> second,
                                     FlowDomain domain);

}  // namespace gradus::motion
