#include "reconstruct/poisson/twicing.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/rows.h"
#include "base/types.h"

namespace gradus::reconstruct {
namespace {

// Minimum side of the blocks that share a bound: several times the reach of S, which is 1/α = 5 pixels, and enough
// pixels for ln n = 7 outliers.
constexpr int kMinSide = 32;

int block_count(int length) { return std::max(1, length / kMinSide); }
// Returns where a block begins; block number block_count() begins at `length`.
int block_begin(int length, int block) { return static_cast<int>(int64_t(length) * block / block_count(length)); }

// Returns ‖I − x₀‖² of a pixel.
float squared_residual(const film::GradientImages& images, const Field& estimate, int x, int y) {
  const float* primal = images.primal.data() + (size_t(y) * images.width + x) * images.channels;
  float sum = 0.0f;
  for (int c = 0; c < estimate.channels(); ++c) {
    const float e = primal[c] - estimate.row(y, c)[x];
    sum += e * e;
  }
  return sum;
}

}  // namespace

float outlier_bound_squared(std::vector<float>* squares) {
  const float share = std::log(static_cast<float>(squares->size()));
  if (!(share > 0.0f)) return kInfinity;
  const auto maximum = static_cast<size_t>(std::ceil(share));
  std::partial_sort(squares->begin(), squares->begin() + ptrdiff_t(maximum), squares->end(), std::greater<>());
  // If the k largest squares lie beyond the bound, its square is the sum of the others over ln n − k. The minimum of
  // such k is the solution; the squares are summed from the smallest up.
  double remaining = 0.0, bound = 0.0;
  for (size_t i = maximum; i < squares->size(); ++i) remaining += (*squares)[i];
  for (size_t k = maximum; k-- > 0;) {
    remaining += (*squares)[k];
    const double candidate = remaining / (share - static_cast<float>(k));
    if ((*squares)[k] <= candidate) bound = candidate;
  }
  return static_cast<float>(bound);
}

Twicing::Twicing(const film::GradientImages& images, const Field& estimate, float alpha)
    : weights_(images.width, images.height, 1), dct_(images.width, images.height), data_weight_(alpha * alpha) {
  const int w = images.width, h = images.height;
  for_rows(h, [&](int y) {
    for (int x = 0; x < w; ++x) weights_.row(y)[x] = squared_residual(images, estimate, x, y);
  });
  limit_blocks(&weights_);
}

void limit_blocks(Field* field) {
  const int w = field->width(), h = field->height();
  for_rows(
      block_count(h),
      [&](int row) {
        for (int i = 0; i < block_count(w); ++i) {
          limit_block(block_begin(w, i), block_begin(w, i + 1), block_begin(h, row), block_begin(h, row + 1), field);
        }
      },
      1);
}

void limit_block(int x0, int x1, int y0, int y1, Field* field) {
  std::vector<float> squares;
  for (int y = y0; y < y1; ++y) {
    std::copy_if(field->row(y) + x0, field->row(y) + x1, std::back_inserter(squares),
                 [](float e) { return is_finite(e); });
  }
  const float bound = outlier_bound_squared(&squares);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      float& value = field->row(y)[x];
      value = !is_finite(value) ? 0.0f : value > bound ? std::sqrt(bound / value) : 1.0f;
    }
  }
}

void Twicing::apply(const PoissonPlanes& planes, float* values) const {
  const int w = weights_.width();
  const size_t stride = planes.stride, step = size_t(w) * stride;
  const auto fill = [&](int y, float* row) {
    const float *weight = weights_.row(y), *primal = planes.primal + size_t(y) * step,
                *value = values + size_t(y) * step;
    for (int x = 0; x < w; ++x, primal += stride, value += stride) {
      row[x] = is_finite(*primal) ? data_weight_ * weight[x] * (*primal - *value) : 0.0f;
    }
  };
  const auto take = [&](int y, const float* row) {
    float* value = values + size_t(y) * step;
    for (int x = 0; x < w; ++x, value += stride) *value += row[x];
  };
  const std::unique_ptr<float[]> work(new float[size_t(w) * weights_.height()]);
  dct_.solve(data_weight_, 1, fill, {}, take, work.get());
}

}  // namespace gradus::reconstruct
