// Two frames of a component as grey images on which optical flow works.
#pragma once

#include <array>
#include <span>

#include "motion/optical_flow.h"

namespace gradus::motion {

enum class FlowDomain {
  Logarithmic,  // irradiance: shadows of any brightness stand out alike
  Linear,
};

// Both on one scale, whose ends are the darkest and the brightest but for a few pixels. Noise alone is not drawn out to
// the whole scale. What is not finite counts as black.
std::array<GreyImage, 2> flow_levels(int width, int height, std::span<const Rgb> first, std::span<const Rgb> second,
                                     FlowDomain domain);

}  // namespace gradus::motion
