// A row of the values of a window, for some of its channels. The channels are stored one after another.
#pragma once

#include <algorithm>
#include <vector>

#include "base/types.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

class ValueRow {
 public:
  ValueRow(const WindowSize& size, int first_channel, int channels)
      : size_(size),
        first_(size_t(first_channel)),
        values_(size_t(size.width) * size_t(channels)),
        read_(size_t(size.width) * size_t(size.channels)) {}

  // Loads row y of frame t. Rows below the image are 0.
  void load(const WindowSource& source, RowKind kind, int t, int y) {
    if (y < 0) return static_cast<void>(std::fill(values_.begin(), values_.end(), 0.0f));
    source.read_row(kind, t, y, read_.data());
    const size_t w = size_t(size_.width), channels = values_.size() / w, stride = size_t(size_.channels);
    for (size_t c = 0; c < channels; ++c) {
      const float* from = read_.data() + first_ + c;
      for (size_t x = 0; x < w; ++x, from += stride) values_[c * w + x] = *from;
    }
  }
  // Replaces missing values by 0, for sums in which they have weight 0.
  void replace_missing() {
    for (float& v : values_) v = is_finite(v) ? v : 0.0f;
  }
  const float* channel(int c) const { return values_.data() + size_t(c) * size_t(size_.width); }
  void swap(ValueRow& other) { values_.swap(other.values_); }

 private:
  WindowSize size_;
  size_t first_;
  std::vector<float> values_, read_;
};

}  // namespace gradus::reconstruct
