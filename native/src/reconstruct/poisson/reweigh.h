// Changes the weights of the least squares problem that combines the regression with sampled differences, by comparing
// its solution with the regression. The half-buffers of differences beside highlights agree by chance, so these
// differences seem known far better than they are, while the regression has lost some of the highlight's light. To
// satisfy both, the solver would make the pixels around the highlight black.
#pragma once

#include "reconstruct/poisson/weighted_least_squares.h"

namespace gradus::reconstruct {

// Increases the data weights of pixels that the solution makes too dark: where it has less than a quarter of the
// regression in some channel, the pixel's standard deviation becomes at most half its light, and each call multiplies
// the weight by at least ten. Light is not negative, and the error of a dark pixel is in proportion to its light.
// Returns whether there is such a pixel.
bool clamp_dark_pixels(const Field& regressed, const Field& solution, WeightedLeastSquares* system);

// Reduces the weights of the differences of pixels that moved further from the regression than its variance, `times`
// its squared error, explains. The factor is that variance over the squared distance.
void downweight_differences(const Field& regressed, const Field& solution, const Field& error, float times,
                            WeightedLeastSquares* system);

}  // namespace gradus::reconstruct
