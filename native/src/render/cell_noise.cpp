#include "render/cell_noise.h"

#include <cmath>

#include "reconstruct/noise_left.h"

namespace gradus {
namespace {

// Keeps the relative error of black areas finite; radiance² at display exposure (the measures' constant).
constexpr double kEpsilon = 1e-3;

void add(const std::vector<float>& term, std::vector<float>* sum) {
  if (sum->empty()) sum->resize(term.size(), 0.0f);
  for (size_t i = 0; i < term.size(); ++i) (*sum)[i] += term[i];
}

// What is delivered, its noise, and a noise that is not below the true one; of all components together.
struct NoiseImages {
  std::vector<float> image, noise, most;
};

NoiseImages noise_images(const Frame& frame, uint32_t reconstruction, float alpha, const CancelTest& cancel) {
  const bool is_weighted = reconstruction == GRADUS_RECONSTRUCTION_WEIGHTED || reconstruction == GRADUS_RECONSTRUCTION_L1;
  NoiseImages sum;
  for (int component = 0; component < int(frame.components.size()); ++component) {
    GradientImages images = read_images(frame, component, true);
    if (is_weighted) {
      read_deviations(frame, component, &images);
      add(noise_left_by_l2(images, alpha, cancel), &sum.most);
    }
    const NoiseLeft left = noise_left(images, reconstruction, alpha, cancel);
    add(left.image, &sum.image);
    add(left.noise, &sum.noise);
  }
  if (!is_weighted) sum.most = sum.noise;
  return sum;
}

// Mean over RGB.
double gray(const float* pixel) { return (double(pixel[0]) + pixel[1] + pixel[2]) / 3.0; }
double mean_square(const float* pixel) {
  return (double(pixel[0]) * pixel[0] + double(pixel[1]) * pixel[1] + double(pixel[2]) * pixel[2]) / 3.0;
}

}  // namespace

std::vector<CellNoise> estimate_noise(const Frame& frame, const std::vector<Region>& cells, uint32_t reconstruction, float alpha,
                                      const CancelTest& cancel) {
  const NoiseImages images = noise_images(frame, reconstruction, alpha, cancel);
  const double exposure = double(frame.settings.film_exposure) * frame.settings.film_exposure;
  std::vector<CellNoise> result;
  for (const Region& cell : cells) {
    double error = 0.0, signal = 0.0, relative = 0.0;
    for (int32_t y = cell.y0; y < cell.y1; ++y) {
      for (int32_t x = cell.x0; x < cell.x1; ++x) {
        const size_t i = frame.index(x, y) * size_t(frame.channels);
        const double g = gray(&images.image[i]), s = exposure * g * g + kEpsilon;
        error += exposure * mean_square(&images.most[i]);
        signal += s;
        relative += exposure * mean_square(&images.noise[i]) / s;
      }
    }
    result.push_back({std::sqrt(error / signal), std::sqrt(relative / double(cell.area()))});
  }
  return result;
}

}  // namespace gradus
