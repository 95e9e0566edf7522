#include "reconstruct/l1_weights.h"

#include <algorithm>
#include <cmath>

#include "base/types.h"
#include "reconstruct/rows.h"

namespace gradus {
namespace {

// Enough pixels for a median within a fraction of a percent.
constexpr size_t kMedianSamples = 1 << 16;

struct RowNorm {
  float factor;  // 1 / (channels · scale²)
  float floor_squared;
  // 1/√(e² + floor²) from the sum of squares over channels.
  float weight(float sum) const {
    const float w = 1.0f / std::sqrt(sum * factor + floor_squared);
    return is_finite(sum) ? w : 0.0f;
  }
};

// What stands for a value that is missing; its row's weight is 0, so any finite value would do.
float finite_or_zero(float v) { return is_finite(v) ? v : 0.0f; }

// Of A = W_d + Dᵀ W_g D.
void fill_diagonal(const Field& data_weights, Stencil* matrix) {
  for_rows(matrix->height(), [&](int y) {
    const float *data = data_weights.row(y), *right = matrix->right.row(y), *up = matrix->up.row(y), *down = matrix->up.row(y - 1);
    float* diagonal = matrix->diagonal.row(y);
    for (int x = 0; x < matrix->width(); ++x) diagonal[x] = data[x] + right[x] + right[x - 1] + up[x] + down[x];
  });
  matrix->finish();
}

}  // namespace

L1Planes load_planes(const PoissonPlanes& planes, int width, int height, int channels) {
  L1Planes result(width, height, channels);
  for_rows(height, [&](int y) {
    for (int c = 0; c < channels; ++c) {
      size_t i = size_t(y) * width * planes.stride + size_t(c);
      float *primal = result.primal.row(y, c), *dx = result.dx.row(y, c), *dy = result.dy.row(y, c);
      for (int x = 0; x < width; ++x, i += planes.stride) {
        primal[x] = planes.primal[i];
        dx[x] = planes.dx[i];
        dy[x] = planes.dy[i];
      }
    }
  });
  return result;
}

float robust_scale(const L1Planes& planes) {
  const Field& image = planes.primal;
  const size_t pixels = size_t(image.width()) * image.height(), step = std::max<size_t>(1, pixels / kMedianSamples);
  std::vector<float> values;
  for (size_t i = 0; i < pixels; i += step) {
    const int x = int(i % size_t(image.width())), y = int(i / size_t(image.width()));
    float v = 0.0f;
    if (image.channels() == 3) {
      v = luminance(Rgb(image.row(y, 0)[x], image.row(y, 1)[x], image.row(y, 2)[x]));
    } else {
      for (int c = 0; c < image.channels(); ++c) v += image.row(y, c)[x] / static_cast<float>(image.channels());
    }
    if (is_finite(v) && v > 0.0f) values.push_back(v);
  }
  if (values.empty()) return 1.0f;
  const auto middle = values.begin() + ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void reweight(const L1Planes& planes, const Field& x, float alpha, float scale, float floor, Field* data_weights, Stencil* matrix) {
  const int w = x.width(), h = x.height(), channels = x.channels();

  const RowNorm norm{1.0f / (static_cast<float>(channels) * scale * scale), floor * floor};
  const RowNorm data_norm{norm.factor * alpha * alpha, norm.floor_squared};
  for_rows(h, [&](int y) {
    float *data = data_weights->row(y), *right = matrix->right.row(y), *up = matrix->up.row(y);
    for (float* sums : {data, right, up}) std::fill_n(sums, w, 0.0f);
    for (int c = 0; c < channels; ++c) {
      const float *here = x.row(y, c), *primal = planes.primal.row(y, c), *dx = planes.dx.row(y, c), *dy = planes.dy.row(y, c);
      const float* above = y + 1 < h ? x.row(y + 1, c) : here;
      for (int i = 0; i < w; ++i) {
        const float e = here[i] - primal[i], ex = here[i + 1] - here[i] - dx[i], ey = above[i] - here[i] - dy[i];
        data[i] += e * e;
        right[i] += ex * ex;
        up[i] += ey * ey;
      }
    }
    for (int i = 0; i < w; ++i) {
      data[i] = alpha * alpha * data_norm.weight(data[i]);
      right[i] = norm.weight(right[i]);
      up[i] = norm.weight(up[i]);
    }
    right[w - 1] = 0.0f;  // the last column and row carry no difference
    if (y == h - 1) std::fill_n(up, w, 0.0f);
  });
  fill_diagonal(*data_weights, matrix);
}

void right_side(const Field& data_weights, const Stencil& matrix, const L1Planes& planes, Field* b) {
  const int w = data_weights.width(), h = data_weights.height(), channels = planes.primal.channels();

  for_rows(h, [&](int y) {
    const float *data = data_weights.row(y), *right = matrix.right.row(y), *up = matrix.up.row(y);
    const float* down = y > 0 ? matrix.up.row(y - 1) : nullptr;
    for (int c = 0; c < channels; ++c) {
      const float *primal = planes.primal.row(y, c), *dx = planes.dx.row(y, c), *dy = planes.dy.row(y, c);
      const float* below = y > 0 ? planes.dy.row(y - 1, c) : nullptr;
      float* to = b->row(y, c);
      float flux = 0.0f;  // of the difference from the left
      for (int i = 0; i < w; ++i) {
        const float out = right[i] * finite_or_zero(dx[i]);
        to[i] = data[i] * finite_or_zero(primal[i]) + flux - out - up[i] * finite_or_zero(dy[i]);
        flux = out;
      }
      if (!down) continue;
      for (int i = 0; i < w; ++i) to[i] += down[i] * finite_or_zero(below[i]);
    }
  });
}

}  // namespace gradus
