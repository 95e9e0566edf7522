// How far an image is from a reference: the measures that renderers report, in the definitions of the field.
#pragma once

#include <cstddef>
#include <vector>

namespace gradus::compare {

// Interleaved RGB, row by row.
struct RgbImage {
  int width = 0, height = 0;
  std::vector<float> pixels;
};

struct Metrics {
  double rel_mse =
      0.0;  // mean over pixels and channels of (x−r)² / (ε + gray(r)²), ε = 1e-3, gray = mean of the channels
  double rel_mse_trimmed = 0.0;  // the same without the worst 0.1 % of pixels: a wide gap to rel_mse means fireflies
  double mse = 0.0;
  double log_mse = 0.0;  // of log(1 + x), x clamped to 0
  double smape = 0.0;    // mean |x−r| / (|x| + |r| + ε)
  double ssim =
      0.0;  // of the luminance after the sRGB curve, clamped to [0, 1]; Gaussian window, σ = 1.5 (Wang et al. 2004)
  double mean = 0.0, mean_reference = 0.0;
  double signed_ratio =
      0.0;  // |Σ(x−r)| / Σ|x−r| after 5×5 averaging: near 0 for noise, near 1 for bias (OSPRay's test)
  size_t nonfinite = 0;  // values of x that are not finite; left out of everything else, with their pixel
};

// Throws invalid_argument if the sizes differ or an image is empty.
Metrics compare_images(const RgbImage& image, const RgbImage& reference);

}  // namespace gradus::compare
