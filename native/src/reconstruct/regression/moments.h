// Moments: sums of products over square blocks of pixels, from which the normal equations of windows are made. The
// moments of two adjacent blocks combine to those of their union. Planes are stored in rows, eight blocks to a vector.
//
// Coordinates count from the centre of each block: with another origin, floats could not hold the constant of a window
// with steep slopes.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "reconstruct/regression/window_solve.h"

namespace gradus::reconstruct {

// Several planes of values for one row of blocks.
class Rows {
 public:
  Rows(int count, int width)
      : width_((size_t(width) + kLanes - 1) / kLanes * kLanes), values_(width_ * size_t(count)) {}
  float* operator[](int i) { return values_.data() + width_ * size_t(i); }
  const float* operator[](int i) const { return values_.data() + width_ * size_t(i); }
  int width() const { return int(width_); }
  void clear() { std::fill(values_.begin(), values_.end(), 0.0f); }

 private:
  size_t width_;  // rounded up to whole vectors
  std::vector<float> values_;
};

inline Lanes load(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}
inline void store(const Lanes& lanes, float* to) { std::memcpy(to, &lanes, sizeof(lanes)); }

// Moments of P features and C right sides. The first feature is constant; the last two are the coordinates if
// Coordinates.
template <int P, int C, bool Coordinates>
struct Moments {
  static constexpr int kX = P - 2, kY = P - 1;
  // Order of the planes: products of features, products of features with the right sides, and the sum of w (v² − d²)
  // over the channels.
  static constexpr int kRight = packed(P, 0), kSquares = kRight + P * C, kCount = kSquares + 1;

  // Joins block a[x] with block b[x + shift] into to[x]. The blocks adjoin along coordinate K, and the centre of each
  // is `half` away from their common border.
  template <int K>
  static void join(const Rows& a, const Rows& b, int shift, float half, Rows* to) {
    const int n = a.width() - shift;
    for (int i = 0; i < kCount; ++i) {
      const float *left = a[i], *right = b[i] + shift;
      float* sum = (*to)[i];
      for (int x = 0; x < n; ++x) sum[x] = left[x] + right[x];
    }
    if constexpr (Coordinates) {
      constexpr int kSquare = packed(K, K);
      const auto move = [&](int of, float by, int sum) {
        const float *left = a[of], *right = b[of] + shift;
        float* moved = (*to)[sum];
        for (int x = 0; x < n; ++x) moved[x] += by * (right[x] - left[x]);
      };
      move(packed(K, 0), 2.0f * half, kSquare);
      const float* weight = (*to)[0];
      float* square = (*to)[kSquare];
      for (int x = 0; x < n; ++x) square[x] += half * half * weight[x];
      for (int j = 0; j < P; ++j) {
        if (j != K) move(packed(j, 0), half, j < K ? packed(K, j) : packed(j, K));
      }
      for (int c = 0; c < C; ++c) move(kRight + c, half, kRight + C * K + c);
    }
  }
};

// Estimates of windows, summed over all windows that contain a block: coefficients times the confidence η, η itself,
// and bias times η.
template <int P, int C, bool Coordinates>
struct WindowEstimates {
  static constexpr int kConfidence = P * C, kBias = P * C + 1, kCount = P * C + 2;

  // Adds to to[x] the estimates of a[x] for its lower half and those of b[x − shift] for its upper half. This is the
  // adjoint of Moments::join().
  template <int K>
  static void split(const Rows& a, const Rows& b, int shift, float half, Rows* to) {
    const int n = a.width();
    for (int i = 0; i < kCount; ++i) {
      const float *left = a[i], *right = b[i] - shift;
      float* sum = (*to)[i];
      for (int x = shift; x < n; ++x) sum[x] += left[x] + right[x];
    }
    if constexpr (Coordinates) {
      for (int c = 0; c < C; ++c) {
        const float *left = a[C * K + c], *right = b[C * K + c] - shift;
        float* sum = (*to)[c];
        for (int x = shift; x < n; ++x) sum[x] += half * (right[x] - left[x]);
      }
    }
  }
};

}  // namespace gradus::reconstruct
