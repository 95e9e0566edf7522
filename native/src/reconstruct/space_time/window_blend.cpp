#include "reconstruct/space_time/window_blend.h"

namespace gradus {

void WindowBlend::add(int window, int frame, std::vector<float> image) {
  const float share = grid_.share(window, frame);
  if (share < 1.0f) {
    for (float& value : image) value *= share;
  }
  if (const auto begun = begun_.find(frame); begun != begun_.end()) {
    for (size_t i = 0; i < image.size(); ++i) image[i] += begun->second[i];
    begun_.erase(begun);
  }
  const bool more = window < grid_.last_with(frame);
  if (more) {
    begun_.emplace(frame, std::move(image));
  } else {
    take_(frame, std::move(image));
  }
}

}  // namespace gradus
