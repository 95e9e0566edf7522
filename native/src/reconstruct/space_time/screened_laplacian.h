// The matrix W_s + Dᵀ W_g D on one grid. A frame's own rows give such a matrix for its pixels; temporal and mixed rows
// give one for the differences along correspondences.
#pragma once

#include <vector>

#include "reconstruct/space_time/weight_plane.h"

namespace gradus::reconstruct {

struct ScreenedLaplacian {
  ScreenedLaplacian(int width, int height) : screen(width, height), right(width, height), up(width, height) {}
  int width() const { return screen.width(); }
  int height() const { return screen.height(); }

  WeightPlane screen;     // W_s without the factor
  WeightPlane right, up;  // W_g; 0 in the last column and row
  float factor = 1.0f;    // factor of all values of `screen`
};

// The weights of all rows of the system that contain pixels of one image row.
class LaplacianRow {
 public:
  explicit LaplacianRow(int width)
      : width_(width), screen_(width), up_(width), down_(width), right_(size_t(width) + 1, 0.0f) {}
  void load(const ScreenedLaplacian& from, int y) {
    from.screen.read_row(y, screen_.data());
    for (float& s : screen_) s *= from.factor;
    from.right.read_row(y, right_.data() + 1);
    from.up.read_row(y, up_.data());
    from.up.read_row(y - 1, down_.data());
  }
  const float* screen() const { return screen_.data(); }
  const float* right() const { return right_.data() + 1; }  // readable from -1 on
  const float* up() const { return up_.data(); }
  const float* down() const { return down_.data(); }  // `up` of the row below

  // Computes one row of the product. Values must be readable one pixel to the left and right.
  void apply(const float* below, const float* here, const float* above, float* out) const {
    const float *s = screen(), *r = right(), *u = up(), *d = down();
    for (int i = 0; i < width_; ++i) {
      const float x = here[i];
      out[i] = s[i] * x + r[i] * (x - here[i + 1]) + r[i - 1] * (x - here[i - 1]) + u[i] * (x - above[i]) +
               d[i] * (x - below[i]);
    }
  }

 private:
  int width_;
  std::vector<float> screen_, up_, down_, right_;
};

}  // namespace gradus::reconstruct
