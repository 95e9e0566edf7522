#include "output/combine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "film/region_pixels.h"
#include "output/pass_read.h"
#include "reconstruct/reconstruct_film.h"

namespace gradus::output {
namespace {

constexpr double kMaxFloat = std::numeric_limits<float>::max();
constexpr int kPixels = 4096;  // Number of pixels that one task handles.

// Returns a function of (pixel, channel) that gives a value of a reconstructed image as it is delivered: multiplied by
// the exposure, and not negative unless the reconstruction keeps negative values.
auto value_of(const film::Film& film, uint32_t reconstruction, const std::vector<float>& image) {
  const float exposure = film.settings.film_exposure,
              minimum = reconstruct::keeps_negative(reconstruction) ? -INFINITY : 0.0f;
  const auto channels = size_t(film.color_channels);
  return [&image, exposure, minimum, channels](size_t i, size_t c) {
    return exposure * std::max(image[i * channels + c], minimum);
  };
}

// Distributes a change of one picture value over the components, in proportion to their absolute values. The last
// component takes the change where all components are 0.
void spread(float change, size_t value, std::vector<std::vector<float>>* components) {
  float light = 0.0f;
  for (const std::vector<float>& component : *components) light += std::fabs(component[value]);
  if (light > 0.0f) {
    for (std::vector<float>& component : *components)
      component[value] += change * (std::fabs(component[value]) / light);
  } else {
    components->back()[value] += change;
  }
}

}  // namespace

std::vector<float> crop_error(const film::Film& film, const std::vector<float>& error, const Region& region) {
  const double scale = double(film.settings.film_exposure) * film.settings.film_exposure;
  std::vector<float> result(size_t(region.area()));
  for_pixels(film, region, [&](size_t i, size_t out) { result[out] = float(std::min(kMaxFloat, scale * error[i])); });
  return result;
}

std::vector<float> combine(const film::Film& film, uint32_t reconstruction, float alpha, const Region& region,
                           const CancelCheck& cancel, reconstruct::SolveReport* report, std::vector<float>* error,
                           std::vector<std::vector<float>>* components) {
  const bool solves = reconstruction != GRADUS_RECONSTRUCTION_NONE;
  reconstruct::Reconstructed solved;
  if (solves || error != nullptr || components != nullptr) {
    solved = reconstruct::reconstruct_film(film, reconstruction, alpha, {error != nullptr, components != nullptr},
                                           cancel, report);
  }
  if (components != nullptr) *components = crop_components(film, reconstruction, std::move(solved.components), region);
  if (error != nullptr) *error = crop_error(film, solved.error, region);
  if (!solves) {
    std::vector<float> rgba(size_t(region.area()) * 4);
    read_film_pass(film, GRADUS_PASS_NOISY_IMAGE, region, rgba.data());
    return rgba;
  }
  return crop_picture(film, reconstruction, solved.image, region);
}

std::vector<std::vector<float>> crop_components(const film::Film& film, uint32_t reconstruction,
                                                std::vector<std::vector<float>> images, const Region& region) {
  reconstruct::clamp_components(reconstruction, film.color_channels, &images);
  for (std::vector<float>& image : images) {
    std::vector<float> rgb(size_t(region.area()) * 3);
    const auto of_pixel = value_of(film, reconstruction, image);
    for_pixels(film, region, [&](size_t i, size_t out) {
      for (size_t c = 0; c < 3; ++c) rgb[3 * out + c] = of_pixel(i, c);
    });
    image = std::move(rgb);
  }
  return images;
}

void follow_picture(const std::vector<float>& before, const std::vector<float>& after,
                    std::vector<std::vector<float>>* components) {
  if (components->empty()) return;
  for_pieces(
      int(before.size() / 4),
      [&](int begin, int end) {
        for (auto p = size_t(begin); p < size_t(end); ++p) {
          for (size_t c = 0; c < 3; ++c) spread(after[4 * p + c] - before[4 * p + c], 3 * p + c, components);
        }
      },
      kPixels);
}

std::vector<float> crop_picture(const film::Film& film, uint32_t reconstruction, const std::vector<float>& image,
                                const Region& region) {
  std::vector<float> rgba(size_t(region.area()) * 4);
  const auto channels = size_t(film.color_channels);
  const auto of_pixel = value_of(film, reconstruction, image);
  for_pixels(film, region, [&](size_t i, size_t out) {
    for (size_t c = 0; c < 3; ++c) rgba[4 * out + c] = of_pixel(i, c);
    rgba[4 * out + 3] = channels == 4 ? std::clamp(image[4 * i + 3], 0.0f, 1.0f) : 1.0f;
  });
  return rgba;
}

}  // namespace gradus::output
