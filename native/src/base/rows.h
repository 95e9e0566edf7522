// Parallel loops and sums over the rows of an image, in the current TBB arena. One thread computes a whole row, and the
// sums of rows are added in order, so results do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/fpu.h"

namespace gradus {

// Grain of passes that compute a few rows around each piece twice.
inline constexpr int kGrainOfStencils = 64;

// Calls function(begin, end) for ranges that together cover [0, height), in parallel. Ranges of at most `grain` rows
// are not split.
template <class Function>
void for_pieces(int height, Function&& function, int grain = 32) {
  if (height <= grain) return static_cast<void>(function(0, height));  // a task would cost more than it saves
  tbb::parallel_for(tbb::blocked_range<int>(0, height, grain), [&](const tbb::blocked_range<int>& range) {
    const FlushDenormals flush;
    function(range.begin(), range.end());
  });
}

// Calls function(y) for each row y of [0, height), in parallel. Ranges of at most `grain` rows are not split.
template <class Function>
void for_rows(int height, Function&& function, int grain = 32) {
  for_pieces(
      height,
      [&](int begin, int end) {
        for (int y = begin; y < end; ++y) function(y);
      },
      grain);
}

// Holds one sum for each channel.
using Sums = std::vector<double>;

// Sums of single rows, for each channel. Threads fill it by row; total() adds the rows in order.
class RowSums {
 public:
  RowSums(int height, int channels) : channels_(channels), parts_(size_t(height) * size_t(channels)) {}
  double& at(int y, int channel) { return parts_[size_t(y) * channels_ + size_t(channel)]; }
  Sums total() const {
    Sums sums(channels_, 0.0);
    for (size_t i = 0; i < parts_.size(); ++i) sums[i % channels_] += parts_[i];
    return sums;
  }
  // Returns the largest magnitude of a row's sum, over all rows and channels.
  double largest() const {
    double largest = 0.0;
    for (const double part : parts_) largest = std::max(largest, std::fabs(part));
    return largest;
  }

 private:
  size_t channels_;
  std::vector<double> parts_;
};

// Computes the sum of each row and channel, in parallel. function(y, channel) returns that sum as a double.
template <class Function>
RowSums sum_each_row(int height, int channels, Function&& function) {
  RowSums sums(height, channels);
  for_rows(height, [&](int y) {
    for (int c = 0; c < channels; ++c) sums.at(y, c) = function(y, c);
  });
  return sums;
}

// Computes the sum over all rows for each channel, in parallel. function(y, channel) returns the sum of a row.
template <class Function>
Sums sum_rows(int height, int channels, Function&& function) {
  return sum_each_row(height, channels, function).total();
}

// A ring buffer of three rows of an image that is computed row by row and never stored as a whole: row y overwrites row
// y - 3. A row has kPad zeros on either side, which stencils may read. y is at least -3.
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

// Returns the dot product of two rows. Blocks of 64 products are added in float with 8 lanes, and blocks in double.
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
