// Pixel filters by importance sampling. The film offset of a sample is drawn with the filter as its density, so that
// all samples have the same weight. Base and offset paths share the film offset, which gives exact gradients for any
// filter.
#pragma once

#include <array>
#include <cstdint>

#include "base/types.h"

namespace gradus::camera {

class FilmFilter {
 public:
  FilmFilter() = default;
  // `type` is a GradusPixelFilter. `width` is in pixels and has the meaning of Cycles' filter width, about the filter's
  // width at a tenth of its height. The box filter ignores it and is one pixel wide.
  FilmFilter(uint32_t type, float width);
  // Returns the offset from the pixel's centre in pixels, for u in [0, 1)².
  Vec2 sample(const Vec2& u) const { return Vec2(sample_axis(u.x), sample_axis(u.y)); }

 private:
  static constexpr int kCells = 1024;
  float sample_axis(float u) const;
  std::array<float, kCells + 1> inverse_{};  // Inverse of the cumulative distribution, in pixels.
};

}  // namespace gradus::camera
