// Means over squares of pixels, as far as they lie in the image.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Mean over (2·radius + 1)² pixels, each channel by itself. Every sum is taken anew: sums that slide would keep the
// rounding of what was bright in the shade beside it. radius: no more than the 8 pixels of zeros around a field.
Field box_mean(const Field& image, int radius);

}  // namespace gradus::reconstruct
