// Test whether the samples of another frame show the same light as a picture, from the noise of both.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// What may have changed between the samples of two frames.
struct LightChange {
  Field difference;  // of the samples, less what comes from their fractions of a pixel; three channels
  Field variance;    // of that difference, three channels
  Field weight;      // of the pixel in means, 0 where there is no sample
};

// Returns the share of each pixel's weight that is kept, 0 to 1. In squares of several sizes around each pixel, the
// mean difference is compared with its standard deviation (Welch 1947, "The generalization of Student's problem when
// several different population variances are involved").
Field same_light(const LightChange& change);

}  // namespace gradus::reconstruct
