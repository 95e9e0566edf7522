// Test whether a frame shows the same light as another one, from the noise of both.
#pragma once

#include "reconstruct/regression/halved_image.h"

namespace gradus::reconstruct {

// Returns the share of each pixel's weight that it keeps, 0 to 1. `difference` is that of the two frames' samples, less
// what comes from their fractions of a pixel; `variance` is the variance of that difference, and `weights` are 0 where
// there is none. Around each pixel, in squares of several sizes, the mean difference is compared with its standard
// deviation (Welch 1947).
Field same_light(const Field& difference, const Field& variance, const Field& weights);

}  // namespace gradus::reconstruct
