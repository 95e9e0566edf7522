// The light around each pixel, by whose share errors and residuals count.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// What is dark does not count as darker than this, in median luminances.
inline constexpr float kDark = 0.02f;

// Squared mean luminance over (2·radius + 1)² pixels, of an image in median luminances, kDark added to it. One channel.
Field squared_light(const Field& image, int radius);

}  // namespace gradus::reconstruct
