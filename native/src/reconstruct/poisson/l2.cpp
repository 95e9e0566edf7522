#include "reconstruct/poisson/l2.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/rows.h"
#include "base/types.h"
#include "reconstruct/poisson/poisson_dct.h"
#include "reconstruct/poisson/weighted_least_squares.h"

namespace gradus::reconstruct {
namespace {

// Replaces a missing value by 0: one non-finite number would spread over the whole image.
float guarded(float v) { return is_finite(v) ? v : 0.0f; }

constexpr int kMaxChannels = 4;

// The input is scaled down because the sums of the transforms are as large as the image is long and could overflow. A
// power of two loses no bits.
constexpr float kRoom = 0x1p-24f;

class L2 {
 public:
  L2(int width, int height, int channels, float alpha)
      : dct_(width, height),
        channels_(size_t(channels)),
        row_size_(size_t(width) * channels_),
        data_weight_(alpha * alpha) {}

  // Solves all channels; see solve_l2().
  bool solve(const L2Rows& rows, const L2Take& take, float* work) const {
    std::vector<RightSideRow> done(static_cast<size_t>(dct_.height()));
    const auto fill = [&](int y, float* row) {
      rows(y, [&](const L2Row& in) { done[size_t(y)] = fill_row(in, y, row); });
    };
    const auto sum = [&](int channel) {
      double total = 0.0;
      for (const RightSideRow& row : done) total += row.sums[size_t(channel)];
      return total;
    };
    const auto take_scaled = [&](int y, const float* row) {
      std::vector<float> values(row, row + row_size_);
      for (float& v : values) v *= 1.0f / kRoom;
      take(y, values.data());
    };
    dct_.solve(data_weight_, int(channels_), fill, sum, take_scaled, work);
    return std::all_of(done.begin(), done.end(), [](const RightSideRow& row) { return row.complete; });
  }

 private:
  struct RightSideRow {
    std::array<double, kMaxChannels> sums{};  // sums of α²I by channel; Dᵀg sums to 0 over the image
    bool complete = true;
  };

  // Writes one row of the right side, α²I + Dᵀg, times kRoom.
  RightSideRow fill_row(const L2Row& in, int y, float* row) const {
    const bool has_up = y + 1 < dct_.height(), has_down = y > 0;
    const float up = has_up ? kRoom : 0.0f, down = has_down ? kRoom : 0.0f;
    const float *dy = has_up ? in.dy : in.primal, *dy_below = has_down ? in.dy_below : in.primal;
    // Differences to the right. There is none in front of the first pixel and behind the last.
    std::vector<float> flux(row_size_ + channels_, 0.0f), values(row_size_), right_side(row_size_);
    int missing = 0;
    for (size_t i = 0; i + channels_ < row_size_; ++i) {
      flux[channels_ + i] = kRoom * guarded(in.dx[i]);
      missing |= !is_finite(in.dx[i]);
    }
    for (size_t i = 0; i < row_size_; ++i) {
      values[i] = kRoom * data_weight_ * guarded(in.primal[i]);
      right_side[i] = values[i] + (flux[i] - flux[channels_ + i]) + (down * guarded(dy_below[i]) - up * guarded(dy[i]));
      missing |= !is_finite(in.primal[i]) | !is_finite(dy[i]);
    }
    RightSideRow result;
    result.complete = missing == 0;
    const size_t width = row_size_ / channels_;
    for (size_t c = 0; c < channels_; ++c) {
      for (size_t x = 0; x < width; ++x) {
        row[c * width + x] = right_side[x * channels_ + c];
        result.sums[c] += values[x * channels_ + c];
      }
    }
    return result;
  }

  PoissonDct dct_;
  size_t channels_, row_size_;
  float data_weight_;
};

// Copies row y of the first `channels` channels of a plane.
std::vector<float> compact_row(const float* plane, size_t stride, int width, int channels, int y) {
  std::vector<float> row;
  row.reserve(size_t(width) * size_t(channels));
  const float* from = plane + size_t(y) * size_t(width) * stride;
  for (int x = 0; x < width; ++x, from += stride) row.insert(row.end(), from, from + channels);
  return row;
}

// Goal and maximum number of steps of the iteration for images with gaps.
constexpr CgGoal kGoalWithGaps{.residual = 1e-6f};
constexpr int kMaxStepsWithGaps = 100;

// Writes `weight` for each pixel whose value is known in all channels, and 0 for the others.
void weigh(const std::vector<float>& values, int channels, int width, int y, float weight, float* weights) {
  const float* value = values.data() + size_t(y) * size_t(width) * size_t(channels);
  for (int x = 0; x < width; ++x, value += channels) weights[x] = is_complete(value, channels) ? weight : 0.0f;
}

}  // namespace

L2Rows rows_of(const PoissonPlanes& planes, int width, int channels) {
  const size_t stride = planes.stride;
  if (stride == size_t(channels)) {
    return [planes, step = ptrdiff_t(width) * channels](int y, const L2Use& use) {
      const ptrdiff_t first = y * step;
      use({planes.primal + first, planes.dx + first, planes.dy + first, y > 0 ? planes.dy + first - step : nullptr});
    };
  }
  return [planes, stride, width, channels](int y, const L2Use& use) {
    const auto row = [&](const float* plane, int at) { return compact_row(plane, stride, width, channels, at); };
    const auto primal = row(planes.primal, y), dx = row(planes.dx, y), dy = row(planes.dy, y),
               below = row(planes.dy, std::max(y - 1, 0));
    use({primal.data(), dx.data(), dy.data(), below.data()});
  };
}

bool solve_l2(int width, int height, int channels, float alpha, const L2Rows& rows, const L2Take& take, float* work) {
  if (channels < 1 || channels > kMaxChannels) throw unsupported("an image has 1 to 4 channels");
  return L2(width, height, channels, alpha).solve(rows, take, work);
}

std::optional<std::vector<float>> solve_l2(int width, int height, int channels, float alpha, const L2Rows& rows) {
  const size_t w = size_t(width), n = size_t(channels);
  std::vector<float> image(w * size_t(height) * n);
  const auto interleave = [&](int y, const float* row) {
    float* to = image.data() + size_t(y) * w * n;
    for (size_t x = 0; x < w; ++x) {
      for (size_t c = 0; c < n; ++c) *to++ = row[c * w + x];
    }
  };
  if (!solve_l2(width, height, channels, alpha, rows, interleave, image.data())) return std::nullopt;
  return image;
}

std::vector<float> solve_l2_with_gaps(const film::GradientImages& images, float alpha, const CancelCheck& cancel,
                                      SolveReport* report) {
  const int w = images.width, h = images.height, channels = images.channels;
  WeightedLeastSquares system(w, h, channels);
  for_rows(h, [&](int y) {
    weigh(images.primal, channels, w, y, alpha * alpha, system.data_weights().row(y));
    weigh(images.dx, channels, w, y, 1.0f, system.matrix().right.row(y));
    weigh(images.dy, channels, w, y, 1.0f, system.matrix().up.row(y));
  });
  system.update();
  const PoissonPlanes interleaved = planes_of(images, 0);
  Field x = start_from_l2(interleaved, w, h, channels, alpha);
  const CgReport solve =
      system.solve(load_planes(interleaved, w, h, channels), kGoalWithGaps, kMaxStepsWithGaps, cancel, &x);
  add_solve(solve, report);
  return interleave(x);
}

}  // namespace gradus::reconstruct
