#include "reconstruct/reconstruct_film.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/rows.h"
#include "film/features.h"
#include "reconstruct/error_estimate.h"
#include "reconstruct/poisson/solver.h"
#include "reconstruct/regularized.h"

namespace gradus::reconstruct {
namespace {

void check_readable(const film::Film& film, uint32_t reconstruction) {
  if (reconstruction == GRADUS_RECONSTRUCTION_NONE) return;
  if (reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
    if (!film::has_features(film))
      throw invalid_operation("the film holds no denoising features to reconstruct with: render it with them");
    return;
  }
  if (!film.gradients) throw invalid_operation("the film holds no gradients to reconstruct from");
}

bool is_zero(const std::vector<Radiance>& plane) {
  return std::all_of(plane.begin(), plane.end(), [](const Radiance& value) { return value == Radiance(0.0f); });
}

// Share of the light that must be negative. Images of the world have a few values slightly below 0, which are no light.
constexpr double kMinimumNegativeShare = 1e-3;

// Returns whether all primal and gradient samples of a component are 0.
bool is_black(const film::ComponentPlanes& planes) {
  for (int half = 0; half < film::kHalves; ++half) {
    const auto& gradient = planes.gradient[half];
    if (!is_zero(planes.primal[half]) || !std::all_of(gradient.begin(), gradient.end(), is_zero)) return false;
  }
  return true;
}

}  // namespace

bool has_negative_light(const film::Film& film) {
  double below = 0.0, all = 0.0;
  for (const film::ComponentPlanes& component : film.components) {
    for (const std::vector<Radiance>& half : component.primal) {
      for (const Radiance& value : half) {
        for (int c = 0; c < 3; ++c) {
          below += std::max(-value[c], 0.0f);
          all += std::fabs(value[c]);
        }
      }
    }
  }
  return below > kMinimumNegativeShare * all;
}

bool keeps_negative(const film::Film& film, uint32_t reconstruction) {
  return reconstruction == GRADUS_RECONSTRUCTION_L2 || reconstruction == GRADUS_RECONSTRUCTION_NONE ||
         has_negative_light(film);
}

void clamp_components(int channels, std::vector<std::vector<float>>* images) {
  if (images->empty()) return;
  const size_t pixels = images->front().size() / size_t(channels);
  for_rows(int(pixels), [&](int pixel) {
    for (size_t i = size_t(pixel) * size_t(channels); i < size_t(pixel) * size_t(channels) + 3; ++i) {
      float sum = 0.0f, light = 0.0f;
      for (const std::vector<float>& image : *images) {
        sum += image[i];
        light += std::max(image[i], 0.0f);
      }
      const float share = light > 0.0f ? std::max(sum, 0.0f) / light : 0.0f;
      if (share == 1.0f) continue;
      for (std::vector<float>& image : *images) image[i] = share * std::max(image[i], 0.0f);
    }
  });
}

void add_image(std::vector<float> term, std::vector<float>* sum) {
  if (sum->empty()) return sum->swap(term);
  for (size_t i = 0; i < term.size(); ++i) (*sum)[i] += term[i];
}

std::vector<float> reconstruct_component(const film::Film& film, int component, uint32_t reconstruction, float alpha,
                                         const CancelCheck& cancel, SolveReport* report) {
  if (is_black(film.components[size_t(component)]))
    return std::vector<float>(size_t(film.region.area()) * size_t(film.color_channels));
  if (reconstruction == GRADUS_RECONSTRUCTION_NONE) return film::read_images(film, component).primal;
  return reconstruct(film, component, reconstruction, alpha, cancel, report);
}

Reconstructed reconstruct_film(const film::Film& film, uint32_t reconstruction, float alpha,
                               ReconstructionOutputs wanted, const CancelCheck& cancel, SolveReport* report) {
  check_readable(film, reconstruction);
  if (reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
    const ErrorUse use = wanted.error ? ErrorUse::Delivered : ErrorUse::Weights;
    Reconstructed result = regularize(film, wanted.components, cancel, report, use);
    if (!wanted.error) result.error = {};
    return result;
  }
  Reconstructed sum;
  ErrorTerms terms;
  for (int component = 0; component < int(film.components.size()); ++component) {
    std::vector<float> part = reconstruct_component(film, component, reconstruction, alpha, cancel, report);
    if (wanted.error) {
      ErrorTerms of_part = error_terms(film, component, reconstruction, alpha, part, cancel);
      add_image(std::move(of_part.noise), &terms.noise);
      add_image(std::move(of_part.l2_difference), &terms.l2_difference);
    }
    if (wanted.components) sum.components.push_back(part);
    add_image(std::move(part), &sum.image);
  }
  if (!terms.noise.empty())
    sum.error = error_of_pixels(terms, film.region.width(), film.region.height(), film.color_channels);
  return sum;
}

}  // namespace gradus::reconstruct
