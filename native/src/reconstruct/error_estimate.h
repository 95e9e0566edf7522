// Estimated squared error of a reconstruction, from the two halves: what stops cells, and the pass Error
// (contract 6.4).
//
// NONE and L2 are linear: the square of what they make of half the difference of the halves has the variance as its
// mean. L1's weights follow that difference and hide a part of it. Its estimate is L2's less the squared distance of
// their image from L2's, for of two estimates of the same the better one's error is uncorrelated with the distance
// between them, else one could mend it by that: var(x_L2) = var(x) + var(x − x_L2) (Hausman 1978, "Specification tests
// in econometrics", for least squares with and without weights). L2's weights are fixed, so that its noise is known
// without bias.
#pragma once

#include <vector>

#include "reconstruct/reconstructed.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// Of GradientImages' layout. image: what `reconstruction` (NONE, L2, L1) makes of the component. Where a half has no
// samples, the other one's mean stands for the difference: its square is no less than the variance on average.
ErrorTerms error_terms(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                       const std::vector<float>& image, const CancelCheck& cancel);

// From means or sums over the same pixels of squared noise and squared distance. A quarter of L2's at least: a
// difference of two estimates may be anything, and below this it would be an accident more often than true
// (docs/method.md).
double squared_error(double noise, double apart);

// Of every pixel, mean over RGB: of the squares in a Gaussian window around it. Finite.
std::vector<float> error_of_pixels(const ErrorTerms& terms, int width, int height, int channels);

// Mean over RGB.
double mean_square(const float* pixel);

}  // namespace gradus::reconstruct
