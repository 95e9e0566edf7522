// Test whether the samples of another frame show the same light as a picture, from the noise of both.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Side in pixels of the cells over which changes are summed.
inline constexpr int kChangeCell = 2;
// Channels of a field of changes: sums over a cell of weight · difference of the samples, less what comes from their
// fractions of a pixel, for three colours, then of weight² · variance of that difference, summed over the colours.
inline constexpr int kChangeVariance = 3, kChangeChannels = 4;

// Returns the share of the samples' weight that is kept in each cell, 0 to 1. In squares of several sizes around it,
// the mean difference is compared with its standard deviation (Welch 1947, "The generalization of Student's problem
// when several different population variances are involved").
Field same_light(Field changes);

}  // namespace gradus::reconstruct
