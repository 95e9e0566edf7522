// Weights of the least squares that joins the regression with differences, set anew by what became of the regression.
// Differences beside highlights, whose halves agree by chance, seem to be far better known than they are, and the
// regression has lost some of the highlight's light: to have both, what lies around it would be black.
#pragma once

#include "reconstruct/weighted_least_squares.h"

namespace gradus::reconstruct {

// Light is not negative, and what is dark is off by a share of itself: where the solution has less than a quarter of
// the regression in some channel, the pixel is held by half its light, each time ten times as firmly. False: there is
// no such pixel.
bool clamp_dark_pixels(const Field& regressed, const Field& solution, WeightedLeastSquares* system);

// Differences of pixels that went further from the regression than its variance says, `times` its squared error, count
// for the less: by that variance over the square of the way.
void downweight_differences(const Field& regressed, const Field& solution, const Field& error, float times,
                            WeightedLeastSquares* system);

}  // namespace gradus::reconstruct
