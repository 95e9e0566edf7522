#include "render/combine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reconstruct/reconstruct_frame.h"
#include "render/pass_read.h"

namespace gradus {
namespace {

constexpr double kMaxFloat = std::numeric_limits<float>::max();

}  // namespace

std::vector<float> crop_error(const Frame& frame, const std::vector<float>& error, const Region& region) {
  const double scale = double(frame.settings.film_exposure) * frame.settings.film_exposure;
  std::vector<float> result;
  result.reserve(size_t(region.area()));
  for (int32_t y = region.y0; y < region.y1; ++y) {
    for (int32_t x = region.x0; x < region.x1; ++x) result.push_back(float(std::min(kMaxFloat, scale * error[frame.index(x, y)])));
  }
  return result;
}

std::vector<float> combine(const Frame& frame, uint32_t reconstruction, float alpha, const Region& region, const CancelTest& cancel,
                           SolveReport* report, std::vector<float>* error, std::vector<std::vector<float>>* components) {
  const bool solves = reconstruction != GRADUS_RECONSTRUCTION_NONE;
  Reconstructed solved;
  if (solves || error != nullptr || components != nullptr) {
    solved = reconstruct_frame(frame, reconstruction, alpha, {error != nullptr, components != nullptr}, cancel, report);
  }
  if (components != nullptr) *components = crop_components(frame, reconstruction, std::move(solved.components), region);
  if (error != nullptr) *error = crop_error(frame, solved.error, region);
  if (!solves) {
    std::vector<float> rgba(size_t(region.area()) * 4);
    read_frame_pass(frame, GRADUS_PASS_NOISY_IMAGE, region, rgba.data());
    return rgba;
  }
  return crop_picture(frame, reconstruction, solved.image, region);
}

std::vector<std::vector<float>> crop_components(const Frame& frame, uint32_t reconstruction, std::vector<std::vector<float>> images,
                                                const Region& region) {
  clamp_components(reconstruction, frame.channels, &images);
  for (std::vector<float>& image : images) {
    const std::vector<float> rgba = crop_picture(frame, reconstruction, image, region);
    image.clear();
    for (size_t i = 0; i < rgba.size(); i += 4) image.insert(image.end(), {rgba[i], rgba[i + 1], rgba[i + 2]});
  }
  return images;
}

void follow_picture(const std::vector<float>& before, const std::vector<float>& after, std::vector<std::vector<float>>* components) {
  if (components->empty()) return;
  for (size_t i = 0; i < before.size() / 4 * 3; ++i) {
    const size_t value = i / 3 * 4 + i % 3;
    float light = 0.0f;
    for (const std::vector<float>& component : *components) light += std::fabs(component[i]);
    const float change = after[value] - before[value];
    if (light > 0.0f) {
      for (std::vector<float>& component : *components) component[i] += change * (std::fabs(component[i]) / light);
    } else {
      components->back()[i] += change;
    }
  }
}

std::vector<float> crop_picture(const Frame& frame, uint32_t reconstruction, const std::vector<float>& image, const Region& region) {
  std::vector<float> rgba(size_t(region.area()) * 4);
  const float exposure = frame.settings.film_exposure;
  float* p = rgba.data();
  for (int32_t y = region.y0; y < region.y1; ++y) {
    for (int32_t x = region.x0; x < region.x1; ++x, p += 4) {
      const float* from = image.data() + frame.index(x, y) * size_t(frame.channels);
      for (int c = 0; c < 3; ++c) p[c] = exposure * (keeps_negative(reconstruction) ? from[c] : std::max(from[c], 0.0f));
      p[3] = frame.channels == 4 ? std::clamp(from[3], 0.0f, 1.0f) : 1.0f;
    }
  }
  return rgba;
}

}  // namespace gradus
