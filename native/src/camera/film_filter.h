// Pixel filters by importance sampling: the sample's film offset is drawn with the density of the filter, so that every
// sample weighs the same and base and shifted paths, which share the offset, give exact gradients for any filter.
#pragma once

#include <array>
#include <cstdint>

#include "base/types.h"

namespace gradus::camera {

class FilmFilter {
 public:
  FilmFilter() = default;
  // type: GradusPixelFilter. width: in pixels, as Cycles understands it: about the width at a tenth of the height; the
  // box is always one pixel wide.
  FilmFilter(uint32_t type, float width);
  // Offset from the pixel's centre.
  Vec2 sample(const Vec2& u) const { return Vec2(sample_axis(u.x), sample_axis(u.y)); }

 private:
  static constexpr int kCells = 1024;
  float sample_axis(float u) const;
  std::array<float, kCells + 1> inverse_{};  // inverse of the cumulated filter over its support
};

}  // namespace gradus::camera
