// Synthetic films with one sample in each half-buffer: an image, its noise and features of any kind.
#pragma once

#include <functional>

#include "film/film.h"
#include "reconstruct/test_images.h"
#include "schema/pass_table.h"

namespace gradus::test {

struct FeatureFilm {
  int width, height;
  std::vector<float> truth;  // three channels
  // Standard deviation of a pixel of a half-buffer.
  std::function<float(size_t)> sigma = [](size_t) { return 0.4f; };
  // Features: normal, albedo and depth, seven values, by pixel and half-buffer.
  std::function<float(int x, int y, int channel, int half)> feature;
  bool gradients = false;
  float difference_sigma = 0.0f;  // standard deviation of one half-buffer's share of a difference
  unsigned seed = 1;
};

inline void fill_features(const FeatureFilm& description, film::Film* film) {
  film::add_pass_channels(schema::feature_passes(), film);
  int first = 0;
  for (const uint32_t pass :
       {GRADUS_PASS_DENOISING_NORMAL, GRADUS_PASS_DENOISING_ALBEDO, GRADUS_PASS_DENOISING_DEPTH}) {
    for (film::Channel& plane : film->channels) {
      if (plane.pass != pass) continue;
      for (int half = 0; half < film::kHalves; ++half) {
        for (size_t i = 0; i < plane.values[half].size(); ++i) {
          const int pixel = int(i / plane.info.values_per_pixel), channel = first + int(i % plane.info.values_per_pixel);
          plane.values[half][i] =
              description.feature(pixel % description.width, pixel / description.width, channel, half);
        }
      }
      first += int(plane.info.values_per_pixel);
    }
  }
}

// Adds one sample of each pixel and half-buffer. The differences of alpha are an eighth of those of red, as alpha is.
inline void fill_differences(const FeatureFilm& description, film::Film* film) {
  const int w = description.width, h = description.height;
  std::mt19937 random(100 + description.seed);
  std::normal_distribution<float> normal(0.0f, 1.0f);
  for (int half = 0; half < film::kHalves; ++half) {
    for (int o = 0; o < film::kOffsets; ++o) {
      for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
          const int nx = x + film::kOffsetX[o], ny = y + film::kOffsetY[o];
          if (nx < 0 || nx >= w || ny < 0 || ny >= h) continue;
          const size_t i = size_t(y) * size_t(w) + size_t(x), n = size_t(ny) * size_t(w) + size_t(nx);
          film->pair_count[half][o][i] = 1.0f;
          Radiance& difference = film->components[0].gradient[half][o][i];
          for (int c = 0; c < 3; ++c) {
            // Each end of a pair contributes half.
            const float truth = 0.5f * (description.truth[3 * n + size_t(c)] - description.truth[3 * i + size_t(c)]);
            difference[c] = truth + description.difference_sigma * normal(random);
          }
          if (film->color_channels == 4) difference[3] = difference[0] / 8.0f;
        }
      }
    }
  }
}

inline film::Film make_feature_film(const FeatureFilm& description, int channels = 3) {
  const int w = description.width, h = description.height;
  film::Film film(uint32_t(w), uint32_t(h), {0, 0, w, h}, channels, 1, description.gradients);
  film.settings.width = uint32_t(w);
  film.settings.height = uint32_t(h);
  std::mt19937 random(description.seed);
  std::normal_distribution<float> normal(0.0f, 1.0f);
  for (int half = 0; half < film::kHalves; ++half) {
    for (size_t i = 0; i < size_t(w) * size_t(h); ++i) {
      film.count[half][i] = 1;
      Radiance& pixel = film.components[0].primal[half][i];
      for (int c = 0; c < 3; ++c)
        pixel[c] = description.truth[3 * i + size_t(c)] + description.sigma(i) * normal(random);
      if (channels == 4) pixel[3] = pixel[0] / 8.0f;
    }
  }
  fill_features(description, &film);
  if (description.gradients) fill_differences(description, &film);
  return film;
}

// Three planes, each with a normal, a checkerboard albedo and a depth of its own.
inline float room_feature(int x, int y, int channel, int /*half*/) {
  if (channel < 3) return channel == (x < 20 ? 0 : y < 15 ? 1 : 2) ? 1.0f : 0.0f;
  if (channel < 6) return (x / 6 + y / 5) % 2 ? 0.8f : 0.2f + 0.1f * float(channel - 3);
  return 3.0f + 0.05f * float(x);
}

inline FeatureFilm room(int w, int h) {
  FeatureFilm film{w, h, {}, [](size_t) { return 0.4f; }, room_feature};
  film.truth = make_image(w, h, 3, [](int x, int y, int c) {
    return (1.0f + 0.01f * float(x) + (y < 15 ? 0.5f : 0.0f)) * room_feature(x, y, 3 + c, 0) + (x < 20 ? 0.3f : 0.0f);
  });
  return film;
}

}  // namespace gradus::test
