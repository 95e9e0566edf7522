// A piecewise-constant density over [0, 1)², for importance maps (pbrt-v4 sections A.4 and A.5).
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace gradus::light {

class Distribution2D {
 public:
  Distribution2D() = default;
  // Builds the density from width·height values in row-major order. They must be non-negative and not all zero.
  Distribution2D(uint32_t width, uint32_t height, const std::vector<float>& values);
  bool empty() const { return width_ == 0; }
  // Returns a point with this density, for u uniform in [0, 1)².
  Vec2 sample(const Vec2& u) const;
  // Returns the density at p in the unit square, over which it integrates to one.
  float density(const Vec2& p) const;
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

 private:
  const float* row(uint32_t y) const { return conditional_.data() + size_t(y) * (width_ + 1); }
  uint32_t find_in_row(uint32_t y, float u) const;

  // Number of values of u per row for which the cell is tabulated. The table narrows the binary search, because a
  // search over a whole row causes many cache misses (Chen and Asau 1974, "On generating random variates from an
  // empirical distribution").
  static constexpr uint32_t kGuides = 128;

  uint32_t width_ = 0, height_ = 0;
  std::vector<uint32_t> guide_;     // Cell of u = k/kGuides: kGuides + 1 values per row.
  std::vector<float> conditional_;  // Cumulative distribution of each row: width + 1 values from 0 to 1.
  std::vector<float> marginal_;     // Cumulative distribution of the rows: height + 1 values from 0 to 1.
};

}  // namespace gradus::light
