#include "render/cell_noise.h"

#include <algorithm>
#include <cmath>

#include "reconstruct/noise_left.h"
#include "reconstruct/rows.h"

namespace gradus {
namespace {

// Keeps the relative error of black areas finite; radiance² at display exposure (the measures' constant).
constexpr double kEpsilon = 1e-3;

void add(std::vector<float> term, std::vector<float>* sum) {
  if (sum->empty()) return sum->swap(term);
  for (size_t i = 0; i < term.size(); ++i) (*sum)[i] += term[i];
}

// Least share of L2's mean squared error that WEIGHTED or L1 may leave: a difference of two estimates can be anything, and below this the
// estimate would be an accident more often than true (docs/method.md).
constexpr double kLeastLeft = 0.25;

bool is_weighted(uint32_t reconstruction) {
  return reconstruction == GRADUS_RECONSTRUCTION_WEIGHTED || reconstruction == GRADUS_RECONSTRUCTION_L1;
}

// What is delivered and its noise by its own weights; where these follow the noise, L2's image and noise as well. Of all components
// together.
struct NoiseImages {
  std::vector<float> image, noise, l2_image, l2_noise;
};

NoiseImages noise_images(const Frame& frame, uint32_t reconstruction, float alpha, const CancelTest& cancel) {
  NoiseImages sum;
  for (int component = 0; component < int(frame.components.size()); ++component) {
    GradientImages images = read_images(frame, component);
    const GradientImages differences = read_half_differences(frame, component);
    if (is_weighted(reconstruction)) {
      NoiseLeft by_l2 = noise_left(images, differences, GRADUS_RECONSTRUCTION_L2, alpha, cancel);
      add(std::move(by_l2.image), &sum.l2_image);
      add(std::move(by_l2.noise), &sum.l2_noise);
      read_deviations(frame, component, &images);
    }
    NoiseLeft left = noise_left(images, differences, reconstruction, alpha, cancel);
    add(std::move(left.image), &sum.image);
    add(std::move(left.noise), &sum.noise);
  }
  return sum;
}

// Mean over RGB.
double gray(const float* pixel) { return (double(pixel[0]) + pixel[1] + pixel[2]) / 3.0; }
double mean_square(const float* pixel) {
  return (double(pixel[0]) * pixel[0] + double(pixel[1]) * pixel[1] + double(pixel[2]) * pixel[2]) / 3.0;
}
double mean_squared_distance(const float* a, const float* b) {
  const float apart[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return mean_square(apart);
}

// Sums over a cell.
struct CellSums {
  double own = 0.0, l2 = 0.0, apart = 0.0;  // squared: noise by the own weights, L2's, distance of image and L2's
  double signal = 0.0, relative = 0.0;

  // Of two estimates of the same, the better one's error is uncorrelated with the distance between them, else one could mend it by that:
  // var(x_L2) = var(x) + var(x − x_L2) (Hausman 1978, "Specification tests in econometrics", for least squares with and without weights).
  // L2's weights are fixed, so that its noise is known without bias.
  double squared_error(bool weighted) const { return weighted ? std::max(l2 - apart, kLeastLeft * l2) : own; }
};

CellNoise noise_of_cell(const Frame& frame, const NoiseImages& images, bool weighted, const Region& cell) {
  const double exposure = double(frame.settings.film_exposure) * frame.settings.film_exposure;
  CellSums sums;
  for (int32_t y = cell.y0; y < cell.y1; ++y) {
    for (int32_t x = cell.x0; x < cell.x1; ++x) {
      const size_t i = frame.index(x, y) * size_t(frame.channels);
      const double g = gray(&images.image[i]), s = exposure * g * g + kEpsilon, own = exposure * mean_square(&images.noise[i]);
      sums.own += own;
      sums.signal += s;
      sums.relative += own / s;
      if (!weighted) continue;
      sums.l2 += exposure * mean_square(&images.l2_noise[i]);
      sums.apart += exposure * mean_squared_distance(&images.image[i], &images.l2_image[i]);
    }
  }
  return {std::sqrt(sums.squared_error(weighted) / sums.signal), std::sqrt(sums.relative / double(cell.area()))};
}

}  // namespace

std::vector<CellNoise> estimate_noise(const Frame& frame, const std::vector<Region>& cells, uint32_t reconstruction, float alpha,
                                      const CancelTest& cancel) {
  const NoiseImages images = noise_images(frame, reconstruction, alpha, cancel);
  const bool weighted = is_weighted(reconstruction);
  std::vector<CellNoise> result(cells.size());
  for_rows(int(cells.size()), [&](int i) { result[size_t(i)] = noise_of_cell(frame, images, weighted, cells[size_t(i)]); });
  return result;
}

}  // namespace gradus
