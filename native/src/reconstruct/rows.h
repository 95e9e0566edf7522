// Loops over rows, spread over the threads of the current arena. Every row is one thread's alone, so results do not depend on threads;
// sums are kept per row and added in order.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <vector>

#include "base/fpu.h"

namespace gradus {

template <class Function>
void for_rows(int height, Function&& function, int grain = 32) {
  const auto run = [&](int begin, int end) {
    for (int y = begin; y < end; ++y) function(y);
  };
  if (height <= grain) return run(0, height);  // coarse grids: no task is worth its cost
  tbb::parallel_for(tbb::blocked_range<int>(0, height, grain), [&](const tbb::blocked_range<int>& range) {
    const FlushDenormals flush;
    run(range.begin(), range.end());
  });
}

// Sum over rows, per channel: function(y, channel) returns a double.
template <class Function>
std::vector<double> sum_rows(int height, int channels, Function&& function) {
  std::vector<double> parts(size_t(height) * size_t(channels));
  for_rows(height, [&](int y) {
    for (int c = 0; c < channels; ++c) parts[size_t(y) * channels + c] = function(y, c);
  });
  std::vector<double> sums(static_cast<size_t>(channels), 0.0);
  for (size_t i = 0; i < parts.size(); ++i) sums[i % size_t(channels)] += parts[i];
  return sums;
}

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
