// Loops over rows, spread over the threads of the current arena. Every row is one thread's alone, so results do not
// depend on threads; sums are kept per row and added in order.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/fpu.h"

namespace gradus {

// Calls function(begin, end) for pieces of [0, height).
template <class Function>
void for_pieces(int height, Function&& function, int grain = 32) {
  if (height <= grain) return static_cast<void>(function(0, height));  // coarse grids: no task is worth its cost
  tbb::parallel_for(tbb::blocked_range<int>(0, height, grain), [&](const tbb::blocked_range<int>& range) {
    const FlushDenormals flush;
    function(range.begin(), range.end());
  });
}

template <class Function>
void for_rows(int height, Function&& function, int grain = 32) {
  for_pieces(
      height,
      [&](int begin, int end) {
        for (int y = begin; y < end; ++y) function(y);
      },
      grain);
}

// One sum per channel.
using Sums = std::vector<double>;

// Parts of sums, to be filled by row and channel.
class RowSums {
 public:
  RowSums(int height, int channels) : channels_(channels), parts_(size_t(height) * size_t(channels)) {}
  double& at(int y, int channel) { return parts_[size_t(y) * channels_ + size_t(channel)]; }
  Sums total() const {
    Sums sums(channels_, 0.0);
    for (size_t i = 0; i < parts_.size(); ++i) sums[i % channels_] += parts_[i];
    return sums;
  }
  // Of the magnitudes.
  double largest() const {
    double largest = 0.0;
    for (const double part : parts_) largest = std::max(largest, std::fabs(part));
    return largest;
  }

 private:
  size_t channels_;
  std::vector<double> parts_;
};

// Sums of rows, per channel: function(y, channel) returns a double.
template <class Function>
RowSums sum_each_row(int height, int channels, Function&& function) {
  RowSums sums(height, channels);
  for_rows(height, [&](int y) {
    for (int c = 0; c < channels; ++c) sums.at(y, c) = function(y, c);
  });
  return sums;
}

// Sum over rows, per channel.
template <class Function>
Sums sum_rows(int height, int channels, Function&& function) {
  return sum_each_row(height, channels, function).total();
}

// Three rows of an image that is made row by row and never stored: row y takes the place of row y - 3. With zeros
// around; y from -3 on.
class RollingRows {
 public:
  RollingRows(int width, int channels)
      : channels_(channels), stride_(size_t(width) + 2 * kPad), values_(3 * size_t(channels) * stride_, 0.0f) {}
  float* row(int y, int channel) {
    return values_.data() + kPad + stride_ * (size_t((y + 3) % 3) * channels_ + size_t(channel));
  }

 private:
  static constexpr size_t kPad = 8;
  size_t channels_, stride_;
  std::vector<float> values_;
};

// Dot product of a row: floats in blocks, blocks in double.
inline double dot_row(const float* a, const float* b, int width) {
  constexpr int kBlock = 64;
  double sum = 0.0;
  for (int x = 0; x < width; x += kBlock) {
    const int end = x + kBlock < width ? x + kBlock : width;
    float lanes[8] = {};
    int i = x;
    for (; i + 8 <= end; i += 8) {
      for (int k = 0; k < 8; ++k) lanes[k] += a[i + k] * b[i + k];
    }
    float part = 0.0f;
    for (; i < end; ++i) part += a[i] * b[i];
    for (const float lane : lanes) part += lane;
    sum += part;
  }
  return sum;
}

}  // namespace gradus
