// Light that the regression loses. Windows weigh samples by noise, so that rare bright samples count too little and the
// picture is too dark, by 5 % of its light at eight samples in a room of glossy surfaces. No pixel can tell which of
// its samples is an outlier; all samples of a large square together know how much light is missing in it.
#pragma once

#include <vector>

#include "reconstruct/field.h"
#include "reconstruct/regression/local_regression.h"

namespace gradus::reconstruct {

// Returns the factors on the regressed picture that restore the light it has lost, three channels. In each square, it
// is the sum of the residuals r, what the samples have more than the picture, times
//   max(0, 1 − Σd²/(Σr)²),
// where d is half the difference of the half-buffers: by their own statistics, one firefly restores nothing, and n of
// them all but 1/n of their light (James, Stein 1961). It goes to the pixels in proportion to their light times √(noise
// over light around them): a light that is seen directly has little noise and loses little. `noise`, one channel, is
// that around each pixel. The samples of each layer count by the share `kept`; empty: in full. All images have three
// channels. Factors are in [0.5, 2].
Field restore_lost_light(const Field& regressed, const Field& noise, const std::vector<Field>& kept,
                         const std::vector<Field>& residuals, const Images& half_differences);

}  // namespace gradus::reconstruct
