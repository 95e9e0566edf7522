// Sums of products over squares of pixels, from which windows' normal equations are made, and how those of two squares
// side by side become those of both. Planes in rows, eight squares to a vector.
//
// Coordinates count from the square's own centre: from anywhere else, floats would not hold the constant of a window
// with steep slopes.
#pragma once

#include <algorithm>
#include <cstring>
#include <vector>

#include "reconstruct/window_solve.h"

namespace gradus::reconstruct {

// Planes of a row of squares.
class Rows {
 public:
  Rows(int count, int width)
      : width_((size_t(width) + kLanes - 1) / kLanes * kLanes), values_(width_ * size_t(count)) {}
  float* operator[](int i) { return values_.data() + width_ * size_t(i); }
  const float* operator[](int i) const { return values_.data() + width_ * size_t(i); }
  int width() const { return int(width_); }
  void clear() { std::fill(values_.begin(), values_.end(), 0.0f); }

 private:
  size_t width_;  // whole vectors
  std::vector<float> values_;
};

inline Lanes load(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}
inline void store(const Lanes& lanes, float* to) { std::memcpy(to, &lanes, sizeof(lanes)); }

// P features, of which the first is constant and the last two are the coordinates if there are such, and C right sides.
template <int P, int C, bool Coordinates>
struct Moments {
  static constexpr int kX = P - 2, kY = P - 1;
  // Products of features, those with the right sides, and w (v² − d²) over the channels.
  static constexpr int kRight = packed(P, 0), kSquares = kRight + P * C, kCount = kSquares + 1;

  // The square made of `a` and of `b`, each with its centre `half` from the other's border along coordinate K: to[x] of
  // a[x], b[x + shift].
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

// What windows say, summed over those that hold a square: coefficients times η, η, bias times η.
template <int P, int C, bool Coordinates>
struct WindowEstimates {
  static constexpr int kConfidence = P * C, kBias = P * C + 1, kCount = P * C + 2;

  // The adjoint of joining: to[x] += what a[x] says of its lower half, and b[x − shift] of its upper one.
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
