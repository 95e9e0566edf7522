// A piecewise-constant density over [0, 1)², for importance maps (pbrt-v4 sections A.4 and A.5).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/huge_pages.h"
#include "base/types.h"

namespace gradus::light {

// Cumulative distributions of the same number of cells, one after the other. Each is searched as a tree of nodes of 16
// values, which are compared at once: a binary search mispredicts most of its branches, and takes a quarter longer.
class CumulativeDistributions {
 public:
  CumulativeDistributions(uint32_t cells, uint32_t count);
  // Sets distribution `index` from `cells` values. They must be non-negative; values that are all zero become uniform.
  // Returns the sum of the values.
  template <class Value>
  double set(uint32_t index, const Value& value);
  // Returns the cell of a distribution whose interval contains u in [0, 1). A cell of zero width is never returned.
  uint32_t find(uint32_t index, float u) const;
  // Returns the position in [0, 1) at which a distribution reaches u, which lies in a cell.
  float within(uint32_t index, uint32_t cell, float u) const;
  // Returns the probability of a cell.
  float probability(uint32_t index, uint32_t cell) const { return upper(index, cell) - lower(index, cell); }

 private:
  static constexpr uint32_t kNode = 16;
  // Returns the cumulative value at the upper, or lower, end of a cell.
  float upper(uint32_t index, uint32_t cell) const {
    return values_[size_t(index) * begin_[levels_] + begin_[levels_ - 1] + cell];
  }
  float lower(uint32_t index, uint32_t cell) const { return cell > 0 ? upper(index, cell - 1) : 0.0f; }

  static constexpr uint32_t kMaxLevels = 8;
  uint32_t cells_ = 0, levels_ = 0;
  std::array<uint32_t, kMaxLevels + 1> begin_{};  // of each level from the top, and the number of values
  // Each distribution has its levels from the top, which is one node. The lowest level has the upper ends of the cells,
  // each other level the last value of each node below it. Nodes are filled up with values above 1.
  HugePageVector<float> values_;
};

class Distribution2D {
 public:
  // Builds the density from width·height values in row-major order. They must be non-negative and not all zero.
  Distribution2D(uint32_t width, uint32_t height, const std::vector<float>& values);
  // Returns a point with this density, for u uniform in [0, 1)².
  Vec2 sample(const Vec2& u) const;
  // Returns the density at p in the unit square, over which it integrates to one.
  float density(const Vec2& p) const;
  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

 private:
  uint32_t width_, height_;
  CumulativeDistributions columns_;  // of each row
  CumulativeDistributions rows_;     // one, of the sums of the rows
};

}  // namespace gradus::light
