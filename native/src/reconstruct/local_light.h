// Mean light around each pixel, relative to which errors and residuals are measured.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Added to the light of every pixel, in units of the median luminance, so that dark pixels do not get an unbounded
// weight.
inline constexpr float kDark = 0.02f;

// Returns (mean + kDark)², one channel. The mean is that of the luminance over (2·radius + 1)² pixels of an image in
// units of its median luminance.
Field squared_light(const Field& image, int radius);

}  // namespace gradus::reconstruct
