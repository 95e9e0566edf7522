// Weights of a kind of rows, one per pixel, in 16 bits: a float without the lower half of its bits (bfloat16). The
// error of 0.4 % does not affect the solution's accuracy, because the rounded weights define the system; 0 and 1 are
// exact.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "base/rows.h"
#include "reconstruct/field.h"

namespace gradus::reconstruct {

class WeightPlane {
 public:
  WeightPlane() = default;
  WeightPlane(int width, int height) : width_(width), height_(height), values_(size_t(width) * size_t(height), 0) {}
  int width() const { return width_; }
  int height() const { return height_; }

  void write_row(int y, const float* from) {
    uint16_t* to = values_.data() + size_t(y) * size_t(width_);
    for (int x = 0; x < width_; ++x) to[x] = uint16_t((std::bit_cast<uint32_t>(from[x]) + 0x8000u) >> 16);
  }
  // Reads row y. Rows beyond the border are 0.
  void read_row(int y, float* to) const {
    if (y < 0 || y >= height_) return static_cast<void>(std::fill_n(to, width_, 0.0f));
    const uint16_t* from = values_.data() + size_t(y) * size_t(width_);
    for (int x = 0; x < width_; ++x) to[x] = std::bit_cast<float>(uint32_t(from[x]) << 16);
  }

 private:
  int width_ = 0, height_ = 0;
  std::vector<uint16_t> values_;
};

// Returns the first channel of a field as weights.
inline WeightPlane to_plane(const Field& field) {
  WeightPlane plane(field.width(), field.height());
  for_rows(field.height(), [&](int y) { plane.write_row(y, field.row(y)); });
  return plane;
}

}  // namespace gradus::reconstruct
