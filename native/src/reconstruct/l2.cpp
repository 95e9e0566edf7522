// L2: minimises α²‖x−I‖² + ‖Dx−g‖² (thesis eq. 5.13 with k = 2). Linear in its input, hence unbiased if the gradients are.
#include "reconstruct/l2.h"

#include <array>

#include "base/error.h"
#include "base/types.h"
#include "reconstruct/poisson_dct.h"

namespace gradus {
namespace {

// A value that is missing counts as none: one non-finite number would spread over the whole image.
float guarded(float v) { return is_finite(v) ? v : 0.0f; }

// Room for the sums of the transforms, which are as large as the image is long: a power of two, so that no bit is lost.
constexpr float kRoom = 0x1p-24f;

class L2 {
 public:
  L2(int width, int height, float alpha) : dct_(width, height), data_weight_(alpha * alpha) {}
  int width() const { return dct_.width(); }

  // Solves kChannels channels side by side, each as if it were alone. rows(y): where row y of all planes begins; `stride`: floats from
  // pixel to pixel.
  template <int kChannels>
  void solve(const L2Rows& rows, size_t stride, float* out) const {
    const int w = dct_.width(), h = dct_.height();
    std::vector<std::array<double, kChannels>> row_sums(static_cast<size_t>(h));
    const auto fill = [&](int y, float* row) {
      rows(y, [&](const L2Row& in) { row_sums[size_t(y)] = fill_row<kChannels>(in, stride, y, row); });
    };
    const auto sum = [&](int channel) {
      double total = 0.0;
      for (const auto& part : row_sums) total += part[size_t(channel)];
      return total;
    };
    const auto take = [&](int y, const float* row) {
      float* to = out + size_t(y) * w * stride;
      for (int x = 0; x < w; ++x, to += stride) {
        for (int c = 0; c < kChannels; ++c) to[c] = row[size_t(c) * w + x] / kRoom;
      }
    };
    const std::unique_ptr<float[]> work(new float[size_t(w) * h * kChannels]);
    dct_.solve(data_weight_, kChannels, fill, sum, take, work.get());
  }

 private:
  // α²I + Dᵀg of one row, times kRoom; returns its part of the sum, which is α²ΣI: the gradients' parts cancel over the image.
  template <int kChannels>
  std::array<double, kChannels> fill_row(const L2Row& in, size_t stride, int y, float* row) const {
    const int w = dct_.width();
    const bool has_up = y + 1 < dct_.height(), has_down = y > 0;
    std::array<double, kChannels> sums{};
    float left[kChannels] = {};
    size_t i = 0;
    for (int x = 0; x < w; ++x, i += stride) {
      for (int c = 0; c < kChannels; ++c) {
        const float value = kRoom * data_weight_ * guarded(in.primal[i + c]);
        const float right = x + 1 < w ? kRoom * guarded(in.dx[i + c]) : 0.0f;
        const float up = has_up ? kRoom * guarded(in.dy[i + c]) : 0.0f;
        const float down = has_down ? kRoom * guarded(in.dy_below[i + c]) : 0.0f;
        row[size_t(c) * w + x] = value + (left[c] - right) + (down - up);
        left[c] = right;
        sums[c] += value;
      }
    }
    return sums;
  }

  PoissonDct dct_;
  float data_weight_;
};

class L2Operator final : public LinearOperator {
 public:
  L2Operator(int width, int height, float alpha) : l2_(width, height, alpha) {}

  void apply(const PoissonPlanes& planes, float* out) const override { l2_.solve<1>(rows_of(planes, l2_.width()), planes.stride, out); }

 private:
  L2 l2_;
};

}  // namespace

L2Rows rows_of(const PoissonPlanes& planes, int width) {
  return [planes, step = ptrdiff_t(width) * ptrdiff_t(planes.stride)](int y, const L2Use& use) {
    const ptrdiff_t first = y * step;
    use({planes.primal + first, planes.dx + first, planes.dy + first, y > 0 ? planes.dy + first - step : nullptr});
  };
}

std::unique_ptr<LinearOperator> make_l2(int width, int height, float alpha) { return std::make_unique<L2Operator>(width, height, alpha); }

std::vector<float> solve_l2(int width, int height, int channels, float alpha, const L2Rows& rows) {
  std::vector<float> result(size_t(width) * height * channels);
  const L2 l2(width, height, alpha);
  switch (channels) {
    case 1:
      l2.solve<1>(rows, 1, result.data());
      break;
    case 3:
      l2.solve<3>(rows, 3, result.data());
      break;
    case 4:
      l2.solve<4>(rows, 4, result.data());
      break;
    default:
      throw unsupported("an image has 1, 3 or 4 channels");
  }
  return result;
}

}  // namespace gradus
