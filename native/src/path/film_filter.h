// Pixel filters by importance sampling: the sample's film offset is drawn with the density of the filter, so that every sample weighs the
// same and base and shifted paths, which share the offset, give exact gradients for any filter.
#pragma once

#include <array>
#include <cstdint>

#include "base/types.h"

namespace gradus {

class FilmFilter {
 public:
  FilmFilter() = default;
  // type: GradusPixelFilter. width: full support in pixels; the box is always one pixel wide (as in Cycles).
  FilmFilter(uint32_t type, float width);
  // Offset from the pixel's centre.
  Vec2 sample(const Vec2& u) const { return Vec2(sample_axis(u.x), sample_axis(u.y)); }

 private:
  static constexpr int kCells = 1024;
  float sample_axis(float u) const;
  std::array<float, kCells + 1> inverse_{};  // inverse of the cumulated filter over [-width/2, width/2]
};

}  // namespace gradus
