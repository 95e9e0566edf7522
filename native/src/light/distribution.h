// Piecewise-constant densities over [0, 1)², for importance maps (pbrt-v4 section A.4 and A.5).
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace gradus::light {

class Distribution2D {
 public:
  Distribution2D() = default;
  // values: width·height, row by row, not negative; not all zero.
  Distribution2D(uint32_t width, uint32_t height, const std::vector<float>& values);
  bool empty() const { return width_ == 0; }
  Vec2 sample(const Vec2& u) const;
  // Density in the unit square, which integrates to one.
  float density(const Vec2& p) const;
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

 private:
  const float* row(uint32_t y) const { return conditional_.data() + size_t(y) * (width_ + 1); }
  uint32_t find_in_row(uint32_t y, float u) const;

  // Steps of u per row for which the cell is known in advance: a search over all of a row waits for memory again and
  // again (Chen and Asau 1974, "On generating random variates from an empirical distribution").
  static constexpr uint32_t kGuides = 128;

  uint32_t width_ = 0, height_ = 0;
  std::vector<uint32_t> guide_;     // cell of u = k/kGuides: kGuides + 1 values per row
  std::vector<float> conditional_;  // cumulated from 0 to 1 in each row: width + 1 values
  std::vector<float> marginal_;     // of the rows: height + 1 values
};

}  // namespace gradus::light
