// Images of the iterative solver: rows of one channel after another ([y][channel][x]), so that weights are read once for all channels and
// inner loops run over contiguous floats. Rows have zeroed padding on both sides, which stencils may read.
#pragma once

#include <cstddef>
#include <vector>

namespace gradus {

class Field {
 public:
  Field() = default;
  Field(int width, int height, int channels)
      : width_(width),
        height_(height),
        channels_(channels),
        stride_((size_t(width) + 2 * kPad - 1) / kPad * kPad + kPad),
        values_(stride_ * size_t(height) * size_t(channels) + kPad, 0.0f) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  float* row(int y, int channel = 0) { return values_.data() + kPad + stride_ * (size_t(y) * size_t(channels_) + size_t(channel)); }
  const float* row(int y, int channel = 0) const {
    return values_.data() + kPad + stride_ * (size_t(y) * size_t(channels_) + size_t(channel));
  }

 private:
  static constexpr size_t kPad = 8;
  int width_ = 0, height_ = 0, channels_ = 0;
  size_t stride_ = 0;
  std::vector<float> values_;
};

}  // namespace gradus
