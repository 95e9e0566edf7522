// Light that the regression loses. Windows weigh samples by noise, so that rare bright samples count too little and the
// picture is too dark, by 5 % of its light at eight samples in a room of glossy surfaces. No pixel can tell which of
// its samples is an outlier; all samples of a large square together know how much light is missing in it.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Light that the samples of each pixel hold, summed over the joined frames by the share s of them that counts.
struct LightOfSamples {
  Field share, light, variance;  // Σ s, Σ s I in three channels, and Σ s² v: v is the variance of I, mean over channels
};

// Returns the factors on the regressed picture that restore the light it has lost, three channels. In each square, it
// is the sum of the residuals r, what the samples have more than the picture, times
//   max(0, 1 − Σv/(Σr)²),
// where v is the variance of the samples: by their own statistics, one firefly restores nothing, and n of them all but
// 1/n of their light (James, Stein 1961). It goes to the pixels in proportion to their light times √(noise over light
// around them): a light that is seen directly has little noise and loses little. `noise`, one channel, is that around
// each pixel. `expected` is the regressed picture where the samples of the second step lie. Factors are in [0.5, 2].
Field restore_lost_light(const Field& regressed, const Field& expected, const Field& noise,
                         const LightOfSamples& samples);

}  // namespace gradus::reconstruct
