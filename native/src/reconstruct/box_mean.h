// Mean over a square around each pixel, as far as that lies in the image.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Returns the mean over (2·radius + 1)² pixels, for each channel. Every sum is computed anew: a sliding sum would carry
// the rounding errors of bright pixels into the dark ones beside them. `radius` is at most 8, the rim of a field.
Field box_mean(const Field& image, int radius);

}  // namespace gradus::reconstruct
