// Images with known gradients for the tests of solvers.
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "reconstruct/poisson/solver.h"
#include "support/statistics.h"

namespace gradus::test {

// Returns the forward differences of an image as a film holds them: 0 in the last column and row.
inline film::GradientImages with_exact_gradients(int width, int height, int channels,
                                                 const std::vector<float>& primal) {
  film::GradientImages images;
  images.width = width;
  images.height = height;
  images.channels = channels;
  images.primal = primal;
  images.dx.assign(primal.size(), 0.0f);
  images.dy.assign(primal.size(), 0.0f);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const size_t i = (size_t(y) * width + x) * channels + c;
        if (x + 1 < width) images.dx[i] = primal[i + channels] - primal[i];
        if (y + 1 < height) images.dy[i] = primal[i + size_t(width) * channels] - primal[i];
      }
    }
  }
  return images;
}

template <class Function>
std::vector<float> make_image(int width, int height, int channels, Function&& value) {
  std::vector<float> image;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) image.push_back(value(x, y, c));
    }
  }
  return image;
}

inline std::vector<float> smooth_image(int width, int height, int channels) {
  return make_image(width, height, channels, [](int x, int y, int c) {
    const float bump = 1.0f / (1.0f + 0.01f * float((x - 9) * (x - 9) + (y - 5) * (y - 5)));
    return 0.1f + bump + 0.2f * std::sin(0.13f * float(x) + 0.7f * float(c)) + (x > 20 ? 0.5f : 0.0f);
  });
}

inline void add_noise(std::vector<float>* image, float sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, sigma);
  for (float& v : *image) v += normal(random);
}

// Returns the mean of two half-buffers of an image with independent noise, and the deviations that they show. sigma: of
// a half-buffer, by pixel.
template <class Sigma>
void average_noisy_halves(std::vector<float>* mean, std::vector<float>* deviation, int channels, const Sigma& sigma,
                          unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal(0.0f, 1.0f);
  deviation->assign(mean->size() / size_t(channels), 0.0f);
  for (size_t i = 0; i < deviation->size(); ++i) {
    float squares = 0.0f;
    for (int c = 0; c < channels; ++c) {
      const float a = sigma(i) * normal(random), b = sigma(i) * normal(random);
      (*mean)[i * channels + c] += 0.5f * (a + b);
      if (c < 3) squares += (a - b) * (a - b);
    }
    (*deviation)[i] = 0.5f * std::sqrt(squares / 3.0f);
  }
}

template <class PixelSigma, class DifferenceSigma>
film::GradientImages noisy_images(int w, int h, int channels, const std::vector<float>& truth, const PixelSigma& pixels,
                                  const DifferenceSigma& differences) {
  film::GradientImages images = with_exact_gradients(w, h, channels, truth);
  average_noisy_halves(&images.primal, &images.primal_deviation, channels, pixels, 1);
  average_noisy_halves(&images.dx, &images.dx_deviation, channels, differences, 2);
  average_noisy_halves(&images.dy, &images.dy_deviation, channels, differences, 3);
  return images;
}

inline film::GradientImages noisy_images(int w, int h, int channels = 3) {
  return noisy_images(
      w, h, channels, smooth_image(w, h, channels), [](size_t) { return 0.4f; }, [](size_t) { return 0.05f; });
}

inline float chequer(int x, int y) { return (x + y) % 2 ? 1.0f : -1.0f; }

inline double max_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double worst = 0.0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(double(a[i]) - b[i]));
  return worst;
}

inline double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
  return std::sqrt(sum / double(a.size()));
}

inline constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {7, 1}, {2, 3}, {33, 17}, {128, 96}, {512, 512}};

inline bool never() { return false; }

}  // namespace gradus::test
