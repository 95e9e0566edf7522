#include "reconstruct/space_time/window_blend.h"

#include "base/fault.h"

namespace gradus::reconstruct {
namespace {

void scale(std::vector<float>* values, float factor) {
  for (float& value : *values) value *= factor;
}

void scale(Reconstructed* picture, float factor) {
  scale(&picture->image, factor);
  scale(&picture->error, factor);
  scale(&picture->terms.noise, factor);
  scale(&picture->terms.l2_difference, factor);
  for (std::vector<float>& component : picture->components) scale(&component, factor);
}

void add_image(const std::vector<float>& from, std::vector<float>* to) {
  for (size_t i = 0; i < to->size(); ++i) (*to)[i] += from[i];
}

void add_picture(const Reconstructed& from, Reconstructed* to) {
  add_image(from.image, &to->image);
  add_image(from.error, &to->error);
  add_image(from.terms.noise, &to->terms.noise);
  add_image(from.terms.l2_difference, &to->terms.l2_difference);
  for (size_t k = 0; k < to->components.size(); ++k) add_image(from.components[k], &to->components[k]);
}

}  // namespace

void WindowBlend::add(int window, int frame, Reconstructed picture) {
  const float share = grid_.share(window, frame);
  if (share < 1.0f) scale(&picture, share);
  if (const auto begun = begun_.find(frame); begun != begun_.end()) {
    if (GRADUS_FAULT(last_window_replaces_others)) {
      scale(&picture, 1.0f / share);
    } else {
      add_picture(begun->second, &picture);
    }
    begun_.erase(begun);
  }
  if (window < grid_.last_with(frame)) {
    begun_.emplace(frame, std::move(picture));
  } else {
    take_(frame, std::move(picture));
  }
}

}  // namespace gradus::reconstruct
