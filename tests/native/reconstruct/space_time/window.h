// Windows with known correspondences and values.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "reconstruct/space_time/window_source.h"

namespace gradus::test {

// A window with all planes in memory: [kind][t], interleaved channels. correspondence[t] has a target for each pixel.
struct Window final : reconstruct::HalvedWindowSource {
  Window(int width, int height, int channels, int frames) : size_{width, height, channels, frames} {
    const size_t pixels = size_t(width) * size_t(height);
    for (auto& kind : planes) kind.assign(size_t(frames), std::vector<float>(pixels * size_t(channels), 0.0f));
    for (auto& kind : halves) kind.assign(size_t(frames), std::vector<float>(pixels * size_t(channels), 0.0f));
    for (auto& kind : deviations)
      kind.assign(size_t(frames), std::vector<float>(pixels, std::numeric_limits<float>::quiet_NaN()));
    correspondence.assign(size_t(frames), std::vector<int32_t>(pixels, film::kNoCorrespondence));
  }
  reconstruct::WindowSize size() const override { return size_; }
  void read_row(reconstruct::RowKind kind, int t, int y, float* out) const override {
    const size_t row = size_t(size_.width) * size_t(size_.channels);
    std::copy_n(plane(kind, t).begin() + ptrdiff_t(size_t(y) * row), row, out);
  }
  void read_half_differences(reconstruct::RowKind kind, int t, int y, float* out) const override {
    const size_t row = size_t(size_.width) * size_t(size_.channels);
    std::copy_n(halves[size_t(kind)][size_t(t)].begin() + ptrdiff_t(size_t(y) * row), row, out);
  }
  void read_correspondence(int t, int y, int32_t* out) const override {
    std::copy_n(correspondence[size_t(t)].begin() + ptrdiff_t(y) * size_.width, size_.width, out);
  }
  std::vector<float>& plane(reconstruct::RowKind kind, int t) { return planes[size_t(kind)][size_t(t)]; }
  const std::vector<float>& plane(reconstruct::RowKind kind, int t) const { return planes[size_t(kind)][size_t(t)]; }

  // One row of the system, Σ sign · pixel, where a pixel is t·width·height + y·width + x. Empty if the system has no
  // such row.
  using Terms = std::vector<std::pair<int, float>>;
  Terms row(reconstruct::RowKind kind, int t, int x, int y) const;
  // Fills the values of all rows from a sequence of images.
  void measure(const std::vector<std::vector<float>>& images);
  template <class Function>
  void for_rows(const Function& function) const {
    for (const reconstruct::RowKind kind : reconstruct::kRowKinds) {
      for (int t = 0; t < size_.frames; ++t) {
        for (int y = 0; y < size_.height; ++y) {
          for (int x = 0; x < size_.width; ++x) {
            const Terms terms = row(kind, t, x, y);
            if (!terms.empty()) function(kind, t, x, y, terms);
          }
        }
      }
    }
  }

  reconstruct::WindowSize size_;
  std::vector<std::vector<float>> planes[6], halves[6], deviations[6];
  std::vector<std::vector<int32_t>> correspondence;
};

inline Window::Terms Window::row(reconstruct::RowKind kind, int t, int x, int y) const {
  const int w = size_.width, n = w * size_.height, i = y * w + x;
  const int right = kind == reconstruct::RowKind::kDx || kind == reconstruct::RowKind::kDxDt,
            up = kind == reconstruct::RowKind::kDy || kind == reconstruct::RowKind::kDyDt;
  if ((right && x + 1 == w) || (up && y + 1 == size_.height)) return {};
  const int j = i + right + up * w, at = t * n;
  if (!reconstruct::is_temporal(kind)) return i == j ? Terms{{at + i, 1.0f}} : Terms{{at + i, -1.0f}, {at + j, 1.0f}};
  if (t + 1 == size_.frames) return {};
  const int there = correspondence[size_t(t)][size_t(i)], other = correspondence[size_t(t)][size_t(j)];
  if (there == film::kNoCorrespondence) return {};
  if (i == j) return {{at + i, -1.0f}, {at + n + there, 1.0f}};
  if (other == film::kNoCorrespondence || other % w != there % w + right || other / w != there / w + up) return {};
  return {{at + i, 1.0f}, {at + j, -1.0f}, {at + n + there, -1.0f}, {at + n + other, 1.0f}};
}

inline void Window::measure(const std::vector<std::vector<float>>& images) {
  const int n = size_.width * size_.height, channels = size_.channels;
  for_rows([&](reconstruct::RowKind kind, int t, int x, int y, const Terms& terms) {
    for (int c = 0; c < channels; ++c) {
      float sum = 0.0f;
      for (const auto& [pixel, sign] : terms) sum += sign * images[size_t(pixel / n)][size_t(pixel % n * channels + c)];
      plane(kind, t)[size_t((y * size_.width + x) * channels + c)] = sum;
    }
  });
}

// Sets correspondences to the rounded positions target(x, y, t). A pixel has none if its target is outside of the
// picture, if another pixel has the same target, or if has_none(x, y, t) is true.
inline void set_correspondences(Window* window, const std::function<std::pair<float, float>(int, int, int)>& target,
                                const std::function<bool(int, int, int)>& has_none) {
  const auto [w, h, channels, frames] = window->size_;
  for (int t = 0; t + 1 < frames; ++t) {
    std::vector<bool> taken(size_t(w) * size_t(h), false);
    for (int y = 0; y < h; ++y) {
      for (int x = 0; x < w; ++x) {
        const auto [fx, fy] = target(x, y, t);
        const int tx = int(std::lround(fx)), ty = int(std::lround(fy));
        if (tx < 0 || ty < 0 || tx >= w || ty >= h || has_none(x, y, t) || taken[size_t(ty * w + tx)]) continue;
        taken[size_t(ty * w + tx)] = true;
        window->correspondence[size_t(t)][size_t(y * w + x)] = ty * w + tx;
      }
    }
  }
}

enum class Motion { kNone, kStatic, kPan, kTurn, kRandom };

inline void set_correspondences(Window* window, Motion motion) {
  const float w = float(window->size_.width), h = float(window->size_.height);
  const auto all_have_one = [](int, int, int) { return false; };
  // Selects a fifth of the pixels, in blobs.
  const auto blobs = [](int x, int y, int t) {
    return std::sin(0.31f * float(x) + float(t)) + std::sin(0.37f * float(y) + 2.0f * float(t)) > 0.83f;
  };
  std::mt19937 random(7);
  switch (motion) {
    case Motion::kNone:
      return;
    case Motion::kStatic:
      return set_correspondences(
          window, [](int x, int y, int) { return std::pair(float(x), float(y)); }, all_have_one);
    case Motion::kPan:
      return set_correspondences(
          window, [](int x, int y, int) { return std::pair(float(x) + 5.0f, float(y) - 3.0f); }, all_have_one);
    case Motion::kTurn:
      return set_correspondences(
          window,
          [=](int x, int y, int) {
            const float dx = 1.03f * (float(x) - 0.5f * w), dy = 1.03f * (float(y) - 0.5f * h), c = std::cos(0.035f),
                        s = std::sin(0.035f);
            return std::pair(0.5f * w + c * dx - s * dy, 0.5f * h + s * dx + c * dy);
          },
          blobs);
    case Motion::kRandom:
      return set_correspondences(
          window,
          [&](int x, int y, int) {
            std::uniform_int_distribution<int> step(-8, 8);
            const int dx = step(random), dy = step(random);
            return std::pair(float(x + dx), float(y + dy));
          },
          all_have_one);
  }
}

}  // namespace gradus::test
