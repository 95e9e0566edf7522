// Estimated squared error of a reconstruction, from the two half-buffers. It stops pixel blocks and is the pass Error.
//
// NONE and L2 are linear, so the square of what they make of half the difference of the half-buffers has the variance
// as its mean. L1's weights follow that difference and hide a part of it. L1's estimate is therefore L2's minus the
// squared distance between the images by L1 and L2. Of two estimates of the same value, the error of the better one is
// uncorrelated with the distance between them, otherwise that distance could improve it further: var(x_L2) = var(x) +
// var(x − x_L2) (Hausman 1978, "Specification tests in econometrics", for least squares with and without weights). L2's
// weights are fixed, so its noise is known without bias.
#pragma once

#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"

namespace gradus::reconstruct {

// Returns images in the layout of GradientImages. `image` is the reconstruction of the component by `reconstruction`
// (NONE, L2 or L1). Where a half-buffer has no samples, the mean of the other one replaces the difference: on average
// its square is at least the variance.
ErrorTerms error_terms(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                       const std::vector<float>& image, const CancelCheck& cancel);

// Returns the squared error from means or sums, over the same pixels, of the squared noise and the squared distance
// from L2. The result is at least a quarter of L2's: the difference of two estimates can be any value, and smaller ones
// were more often chance than true when measured.
double squared_error(double noise, double l2_difference);

// Returns the estimated squared error of every pixel, mean over RGB, from the squares in a Gaussian window around it.
// All values are finite.
std::vector<float> error_of_pixels(const ErrorTerms& terms, int width, int height, int channels);

// Returns the mean of the squares of a pixel's R, G and B.
double mean_square(const float* pixel);

// `image` is W(p_A/2 + p_B/2) and `noise` is W(p_A/2 − p_B/2), where p are the planes of each half-buffer; both have
// the layout of GradientImages. W depends on the noise and so hides a part of it from `noise`: the squares of `noise`
// compare pixels well, but are too small.
struct RemainingNoise {
  std::vector<float> image, noise;
};

// Estimates the noise that remains after L1, from the difference of the two half-buffers. The weights are those of the
// measured noise (minimise_by_noise.h), which are close to L1's and need no iteration. `images` must have deviations;
// `half_differences` belong to the same film (film::read_half_differences()). Channels beyond the third do not take
// part in the weights and stay 0.
RemainingNoise remaining_noise(const film::GradientImages& images, const film::GradientImages& half_differences,
                               float alpha, const CancelCheck& cancel);

}  // namespace gradus::reconstruct
