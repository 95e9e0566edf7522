// A smaller picture of a frame, brought to the frame's own size.
#pragma once

#include <vector>

#include "film/film.h"

namespace gradus::output {

struct ImageSize {
  uint32_t width = 0, height = 0;
};

// Pixels of the frame `small` between whose centres those of `region`, a part of the frame `full`, lie.
Region covering(const Region& region, ImageSize full, ImageSize small);

// Bilinear. image: the pixels covering(region, full, small), their channels side by side. Runs in the caller's arena.
std::vector<float> enlarge(const std::vector<float>& image, size_t channels, const Region& region, ImageSize full,
                           ImageSize small);

}  // namespace gradus::output
