#include "compare/metrics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "base/error.h"
#include "base/types.h"
#include "compare/ssim.h"

namespace gradus::compare {
namespace {

constexpr double kEpsilon = 1e-3;
constexpr double kTrimmedShare = 0.001;
constexpr int kBlock = 5;

bool is_usable(const float* x, const float* r) {
  return is_finite(x[0]) && is_finite(x[1]) && is_finite(x[2]) && is_finite(r[0]) && is_finite(r[1]) && is_finite(r[2]);
}

double log_of(float x) { return std::log1p(std::max(double(x), 0.0)); }

// Sums over the channels of one pixel.
struct PixelError {
  double relative = 0.0, squared = 0.0, log_squared = 0.0, symmetric = 0.0;
};

PixelError pixel_error(const float* x, const float* r) {
  PixelError e;
  const double gray = (double(r[0]) + r[1] + r[2]) / 3.0, scale = kEpsilon + gray * gray;
  for (int c = 0; c < 3; ++c) {
    const double d = double(x[c]) - r[c], l = log_of(x[c]) - log_of(r[c]);
    e.squared += d * d;
    e.relative += d * d / scale;
    e.log_squared += l * l;
    e.symmetric += std::abs(d) / (std::abs(double(x[c])) + std::abs(double(r[c])) + kEpsilon);
  }
  return e;
}

double trimmed_mean(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto dropped = static_cast<size_t>(kTrimmedShare * double(values.size()));
  const auto end = values.end() - ptrdiff_t(dropped);
  if (dropped > 0) std::nth_element(values.begin(), end, values.end());
  return std::accumulate(values.begin(), end, 0.0) / double(end - values.begin());
}

double signed_ratio(const RgbImage& x, const RgbImage& r) {
  double sum = 0.0, absolute = 0.0;
  for (int by = 0; by + kBlock <= x.height; by += kBlock) {
    for (int bx = 0; bx + kBlock <= x.width; bx += kBlock) {
      double block = 0.0;
      for (int y = by; y < by + kBlock; ++y) {
        for (int px = bx; px < bx + kBlock; ++px) {
          const size_t i = 3 * (size_t(y) * size_t(x.width) + size_t(px));
          if (!is_usable(&x.pixels[i], &r.pixels[i])) continue;
          for (int c = 0; c < 3; ++c) block += double(x.pixels[i + c]) - r.pixels[i + c];
        }
      }
      sum += block;
      absolute += std::abs(block);
    }
  }
  return absolute > 0.0 ? std::abs(sum) / absolute : 0.0;
}

}  // namespace

Metrics compare_images(const RgbImage& image, const RgbImage& reference) {
  if (image.width != reference.width || image.height != reference.height) {
    throw invalid_argument("the images differ in size: " + std::to_string(image.width) + " x " +
                           std::to_string(image.height) + " and " + std::to_string(reference.width) + " x " +
                           std::to_string(reference.height));
  }
  if (image.pixels.empty()) throw invalid_argument("the images are empty");
  Metrics m;
  PixelError total;
  std::vector<double> relative;
  for (size_t i = 0; i < image.pixels.size(); i += 3) {
    const float *x = &image.pixels[i], *r = &reference.pixels[i];
    for (int c = 0; c < 3; ++c) m.nonfinite += is_finite(x[c]) ? 0 : 1;
    if (!is_usable(x, r)) continue;
    const PixelError e = pixel_error(x, r);
    total.squared += e.squared;
    total.log_squared += e.log_squared;
    total.symmetric += e.symmetric;
    relative.push_back(e.relative / 3.0);
    for (int c = 0; c < 3; ++c) {
      m.mean += x[c];
      m.mean_reference += r[c];
    }
  }
  const double values = std::max(3.0 * double(relative.size()), 1.0);
  m.rel_mse = std::accumulate(relative.begin(), relative.end(), 0.0) / std::max(double(relative.size()), 1.0);
  m.rel_mse_trimmed = trimmed_mean(std::move(relative));
  m.mse = total.squared / values;
  m.log_mse = total.log_squared / values;
  m.smape = total.symmetric / values;
  m.mean /= values;
  m.mean_reference /= values;
  m.signed_ratio = signed_ratio(image, reference);
  m.ssim = structural_similarity(image, reference);
  return m;
}

}  // namespace gradus::compare
