// Mean over a square around each pixel, as far as that lies in the image, and the mean light around each pixel,
// relative to which errors and residuals are measured.
#pragma once

#include <algorithm>

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Returns how many of the pixels from `at` − radius to `at` + radius lie in a row of this length.
inline int count_within(int at, int radius, int length) {
  return std::min(at + radius, length - 1) - std::max(at - radius, 0) + 1;
}

// Returns the mean over (2·radius + 1)² pixels, for each channel. Every sum is computed anew: a sliding sum would carry
// the rounding errors of bright pixels into the dark ones beside them. `radius` is at most 8, the rim of a field.
Field box_mean(const Field& image, int radius);

// Added to the light of every pixel, in units of the median luminance, so that dark pixels do not get an unbounded
// weight.
inline constexpr float kDark = 0.02f;

// Returns (mean + kDark)², one channel. The mean is that of the luminance over (2·radius + 1)² pixels of an image in
// units of its median luminance.
Field squared_light(const Field& image, int radius);

}  // namespace gradus::reconstruct
