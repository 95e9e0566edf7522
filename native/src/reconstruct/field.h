// Image of the iterative solvers. A row holds one channel after another ([y][channel][x]), so that weights are read
// once for all channels and inner loops run over contiguous floats. A rim of zeros surrounds the image (8 pixels to the
// left and right, and the rows -1 and height), so that stencils need no test at the border.
#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/field_memory.h"

namespace gradus::reconstruct {

// Number of colours of a picture, which may have alpha as a further channel.
inline constexpr int kColors = 3;

class Field {
 public:
  Field() = default;
  Field(int width, int height, int channels)
      : width_(width),
        height_(height),
        channels_(channels),
        stride_((size_t(width) + 2 * kPad - 1) / kPad * kPad + kPad),
        values_(stride_ * (size_t(height) + 2) * size_t(channels) + kPad) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  float* row(int y, int channel = 0) { return values_.data() + first(y, channel); }
  const float* row(int y, int channel = 0) const { return values_.data() + first(y, channel); }

 private:
  size_t first(int y, int channel) const {
    return kPad + stride_ * ((size_t(y) + 1) * size_t(channels_) + size_t(channel));
  }
  static constexpr size_t kPad = 8;
  int width_ = 0, height_ = 0, channels_ = 0;
  size_t stride_ = 0;
  std::vector<float, FieldAllocator<float>> values_;
};

}  // namespace gradus::reconstruct
