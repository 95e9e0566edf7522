// Enlarges a picture of reduced resolution to the full resolution.
#pragma once

#include <vector>

#include "film/film.h"

namespace gradus::output {

struct ImageSize {
  uint32_t width = 0, height = 0;
};

// Returns the pixels of a picture of size `small` that enlarge() needs for `region`, which is a region of the picture
// of size `full`.
Region covering(const Region& region, ImageSize full, ImageSize small);

// Returns the pixels of `region` by bilinear interpolation. `image` holds the pixels of covering(region, full, small)
// with interleaved channels. It runs in the caller's TBB arena.
std::vector<float> enlarge(const std::vector<float>& image, size_t channels, const Region& region, ImageSize full,
                           ImageSize small);

}  // namespace gradus::output
