#include "reconstruct/displaced.h"

#include <algorithm>
#include <cmath>

#include "base/rows.h"

namespace gradus::reconstruct {
namespace {

constexpr int kTaps = 4;  // pixels along each axis

// The pixels that contribute along one axis, and their weights.
struct CubicTaps {
  int at[kTaps];
  float weights[kTaps];
  CubicTaps(float position, int size) {
    const float first = std::floor(position), t = position - first;
    for (int i = 0; i < kTaps; ++i) at[i] = std::clamp(int(first) - 1 + i, 0, size - 1);
    weights[0] = ((-0.5f * t + 1.0f) * t - 0.5f) * t;
    weights[1] = (1.5f * t - 2.5f) * t * t + 1.0f;
    weights[2] = ((-1.5f * t + 2.0f) * t + 0.5f) * t;
    weights[3] = (0.5f * t - 0.5f) * t * t;
  }
};

float sum_of_taps(const Field& image, int channel, const CubicTaps& along_x, const CubicTaps& along_y) {
  float sum = 0.0f;
  for (int j = 0; j < kTaps; ++j) {
    const float* row = image.row(along_y.at[j], channel);
    float of_row = 0.0f;
    for (int i = 0; i < kTaps; ++i) of_row += along_x.weights[i] * row[along_x.at[i]];
    sum += along_y.weights[j] * of_row;
  }
  return sum;
}

}  // namespace

Field displaced(const Field& image, const Field& displacement) {
  const int width = image.width(), height = image.height();
  Field result = image;
  for_rows(height, [&](int y) {
    const float *dx = displacement.row(y, 0), *dy = displacement.row(y, 1);
    for (int x = 0; x < width; ++x) {
      if (dx[x] == 0.0f && dy[x] == 0.0f) continue;
      const CubicTaps along_x(float(x) + dx[x], width), along_y(float(y) + dy[x], height);
      for (int c = 0; c < image.channels(); ++c) result.row(y, c)[x] = sum_of_taps(image, c, along_x, along_y);
    }
  });
  return result;
}

}  // namespace gradus::reconstruct
