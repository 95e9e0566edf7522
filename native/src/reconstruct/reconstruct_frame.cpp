#include "reconstruct/reconstruct_frame.h"

#include <algorithm>

#include "base/error.h"
#include "frame/features.h"
#include "reconstruct/error_estimate.h"

namespace gradus {
namespace {

void check_readable(const Frame& frame, uint32_t reconstruction) {
  if (reconstruction == GRADUS_RECONSTRUCTION_NONE) return;
  if (reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
    if (!has_features(frame)) throw invalid_operation("the frame holds no denoising features to reconstruct with: render it with them");
    return;
  }
  if (!frame.gradients) throw invalid_operation("the frame holds no gradients to reconstruct from");
}

bool is_zero(const std::vector<Radiance>& plane) {
  return std::all_of(plane.begin(), plane.end(), [](const Radiance& value) { return value == Radiance(0.0f); });
}

// Neither its paths nor their offsets have found anything.
bool is_black(const ComponentPlanes& planes) {
  for (int half = 0; half < kHalves; ++half) {
    const auto& gradient = planes.gradient[half];
    if (!is_zero(planes.primal[half]) || !std::all_of(gradient.begin(), gradient.end(), is_zero)) return false;
  }
  return true;
}

}  // namespace

void clamp_component(const Frame& frame, uint32_t reconstruction, size_t components, std::vector<float>* image) {
  if (components < 2 || reconstruction == GRADUS_RECONSTRUCTION_L2) return;
  for (size_t i = 0; i < image->size(); ++i) {
    if (i % size_t(frame.channels) < 3) (*image)[i] = std::max((*image)[i], 0.0f);
  }
}

void add_image(std::vector<float> term, std::vector<float>* sum) {
  if (sum->empty()) return sum->swap(term);
  for (size_t i = 0; i < term.size(); ++i) (*sum)[i] += term[i];
}

Reconstructed reconstruct_component(const Frame& frame, int component, uint32_t reconstruction, float alpha, bool wants_error,
                                    ComponentGuides* guides, const CancelTest& cancel, SolveReport* report) {
  const size_t pixels = size_t(frame.region.area());
  if (is_black(frame.components[size_t(component)])) {
    const bool tells_error = wants_error && reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED;
    return {std::vector<float>(pixels * size_t(frame.channels)), std::vector<float>(tells_error ? pixels : 0)};
  }
  switch (reconstruction) {
    case GRADUS_RECONSTRUCTION_NONE:
      return {read_images(frame, component).primal, {}};
    case GRADUS_RECONSTRUCTION_REGULARIZED: {
      Reconstructed result = regularize(frame, component, guides->of(component), cancel, report);
      if (!wants_error) result.error = {};
      return result;
    }
    default:
      return {reconstruct(frame, component, reconstruction, alpha, cancel, report), {}};
  }
}

Reconstructed reconstruct_frame(const Frame& frame, uint32_t reconstruction, float alpha, bool wants_error, const CancelTest& cancel,
                                SolveReport* report, std::vector<std::vector<float>>* components) {
  check_readable(frame, reconstruction);
  Reconstructed sum;
  ErrorTerms terms;
  ComponentGuides guides(frame);
  for (int component = 0; component < int(frame.components.size()); ++component) {
    Reconstructed part = reconstruct_component(frame, component, reconstruction, alpha, wants_error, &guides, cancel, report);
    if (wants_error && part.error.empty()) {
      ErrorTerms of_part = error_terms(frame, component, reconstruction, alpha, part.image, cancel);
      add_image(std::move(of_part.noise), &terms.noise);
      add_image(std::move(of_part.apart), &terms.apart);
    }
    clamp_component(frame, reconstruction, frame.components.size(), &part.image);
    if (components != nullptr) components->push_back(part.image);
    add_image(std::move(part.image), &sum.image);
    add_image(std::move(part.error), &sum.error);  // as if independent
  }
  if (!terms.noise.empty()) sum.error = error_of_pixels(terms, frame.region.width(), frame.region.height(), frame.channels);
  return sum;
}

}  // namespace gradus
