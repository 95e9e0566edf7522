#include "compare/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/types.h"
#include "image/color.h"

namespace gradus::compare {
namespace {

constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;  // for values in [0, 1]

using Plane = std::vector<double>;

Plane tone_mapped(const RgbImage& image) {
  Plane plane;
  for (size_t i = 0; i < image.pixels.size(); i += 3) {
    Rgb c(image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]);
    if (!is_finite(c)) c = Rgb(0.0f);
    plane.push_back(image::linear_to_srgb(std::clamp(luminance(c), 0.0f, 1.0f)));
  }
  return plane;
}

std::array<double, 2 * kRadius + 1> window() {
  std::array<double, 2 * kRadius + 1> w{};
  for (int i = -kRadius; i <= kRadius; ++i) w[size_t(i + kRadius)] = std::exp(-0.5 * i * i / (kSigma * kSigma));
  return w;
}

// Along one axis; at the border the window is cut and normalised again.
Plane blur_axis(const Plane& plane, int width, int height, bool vertical) {
  const auto weights = window();
  Plane result(plane.size());
  const int length = vertical ? height : width, stride = vertical ? width : 1;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int at = vertical ? y : x;
      double sum = 0.0, weight = 0.0;
      for (int k = std::max(-kRadius, -at); k <= std::min(kRadius, length - 1 - at); ++k) {
        const double w = weights[size_t(k + kRadius)];
        sum += w * plane[size_t(y) * size_t(width) + size_t(x) + size_t(ptrdiff_t(k) * stride)];
        weight += w;
      }
      result[size_t(y) * size_t(width) + size_t(x)] = sum / weight;
    }
  }
  return result;
}

Plane blur(const Plane& plane, int width, int height) {
  return blur_axis(blur_axis(plane, width, height, false), width, height, true);
}

Plane product(const Plane& a, const Plane& b) {
  Plane result(a.size());
  for (size_t i = 0; i < a.size(); ++i) result[i] = a[i] * b[i];
  return result;
}

}  // namespace

double structural_similarity(const RgbImage& image, const RgbImage& reference) {
  const int w = image.width, h = image.height;
  const Plane x = tone_mapped(image), r = tone_mapped(reference);
  const Plane mx = blur(x, w, h), mr = blur(r, w, h);
  const Plane xx = blur(product(x, x), w, h), rr = blur(product(r, r), w, h), xr = blur(product(x, r), w, h);
  double sum = 0.0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double vx = xx[i] - mx[i] * mx[i], vr = rr[i] - mr[i] * mr[i], cov = xr[i] - mx[i] * mr[i];
    sum += (2.0 * mx[i] * mr[i] + kC1) * (2.0 * cov + kC2) / ((mx[i] * mx[i] + mr[i] * mr[i] + kC1) * (vx + vr + kC2));
  }
  return sum / double(x.size());
}

}  // namespace gradus::compare
