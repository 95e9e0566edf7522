// How far an image is from a reference: the measures that renderers report, in the definitions of the field.
#pragma once

#include <cstddef>
#include <vector>

namespace gradus::compare {

// An image with interleaved RGB, row by row.
struct RgbImage {
  int width = 0, height = 0;
  std::vector<float> pixels;
};

// Errors of an image x against a reference r. Unless a field says otherwise, it is a mean over pixels and channels.
struct Metrics {
  // Relative squared error, (x−r)² / (ε + gray(r)²) with ε = 1e-3, where gray is the mean of a pixel's channels.
  double rel_mse = 0.0;
  // rel_mse without the 0.1 % of pixels with the largest errors. If it is far below rel_mse, the image has fireflies.
  double rel_mse_trimmed = 0.0;
  double mse = 0.0;  // squared error, (x−r)²
  // Squared error of log(1 + x), where negative values count as 0.
  double log_mse = 0.0;
  // Symmetric relative error, |x−r| / (|x| + |r| + ε) with ε = 1e-3.
  double smape = 0.0;
  // Structural similarity of the luminance after the sRGB curve, clamped to [0, 1], with a Gaussian window of σ = 1.5
  // pixels (Wang et al. 2004). It is 1 for equal images.
  double ssim = 0.0;
  double mean = 0.0, mean_reference = 0.0;  // mean of x and of r
  // |Σ(x−r)| / Σ|x−r| after averaging over 5×5 pixels: near 0 for noise, near 1 for bias (from OSPRay's tests).
  double signed_ratio = 0.0;
  // Number of values of x that are not finite. Their pixels are left out of all other fields.
  size_t nonfinite = 0;
};

// Compares an image with a reference of the same size. Throws invalid_argument if the sizes differ or an image is
// empty.
Metrics compare_images(const RgbImage& image, const RgbImage& reference);

}  // namespace gradus::compare
