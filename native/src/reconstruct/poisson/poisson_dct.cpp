#include "reconstruct/poisson/poisson_dct.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/fpu.h"

namespace gradus::reconstruct {
namespace {

// Number of columns transformed together: one cache line of floats, so that the image is read and written by whole
// lines.
constexpr int kColumnBlock = 16;
constexpr int kRowGrain = 8;

std::vector<float> eigenvalues(int length) {
  std::vector<float> result(static_cast<size_t>(length));
  for (int k = 0; k < length; ++k) {
    // 2 - 2 cos(πk/N), written so that small values keep their digits.
    const double s = std::sin(std::numbers::pi * k / (2.0 * length));
    result[k] = static_cast<float>(4.0 * s * s);
  }
  return result;
}

using Range = tbb::blocked_range<int>;

// Calls body(y, row y, row y + 1, whether row y + 1 exists, scratch) for every second row y. One complex transform
// handles two rows.
template <class Body>
void for_row_pairs(int w, int h, int channels, float* work, const Body& body) {
  const size_t row = size_t(w) * size_t(channels);
  tbb::parallel_for(Range(0, (h + 1) / 2, kRowGrain), [&](const Range& range) {
    const FlushDenormals flush;
    Dct::Scratch scratch(w);
    std::vector<float> spare(row);
    for (int pair = range.begin(); pair < range.end(); ++pair) {
      const int y = 2 * pair;
      const bool both = y + 1 < h;
      float* const a = work + size_t(y) * row;
      body(y, a, both ? a + row : spare.data(), both, &scratch);
    }
  });
}

}  // namespace

PoissonDct::PoissonDct(int width, int height)
    : row_(width), column_(height), eigenvalue_x_(eigenvalues(width)), eigenvalue_y_(eigenvalues(height)) {}

void PoissonDct::solve(float data_weight, int channels, const FillRow& fill, const Sum& sum, const TakeRow& take,
                       float* work) const {
  rows_forward(channels, fill, work);
  std::vector<double> sums;
  for (int c = 0; c < channels && sum; ++c) sums.push_back(sum(c));
  columns(data_weight, channels, sum ? sums.data() : nullptr, work);
  rows_inverse(channels, take, work);
}

void PoissonDct::rows_forward(int channels, const FillRow& fill, float* work) const {
  const int w = width();
  for_row_pairs(w, height(), channels, work, [&](int y, float* a, float* b, bool both, Dct::Scratch* scratch) {
    fill(y, a);
    if (both) fill(y + 1, b);
    for (int c = 0; c < channels; ++c) row_.forward(a + size_t(c) * w, b + size_t(c) * w, scratch);
  });
}

void PoissonDct::columns(float data_weight, int channels, const double* sums, float* work) const {
  const int w = width(), h = height(), blocks = (w + kColumnBlock - 1) / kColumnBlock;
  const size_t row = size_t(w) * size_t(channels);
  // The forward and inverse transforms of both axes together multiply by the two lengths and by 4.
  const float scale = 1.0f / (static_cast<float>(w) * static_cast<float>(h));
  const auto gains = [&](int x, std::vector<float>* to) {
    const float base = data_weight + eigenvalue_x_[std::min(x, w - 1)];
    for (int y = 0; y < h; ++y) (*to)[y] = scale / (base + eigenvalue_y_[y]);
  };
  tbb::parallel_for(Range(0, blocks * channels, 1), [&](const Range& range) {
    const FlushDenormals flush;
    std::vector<Dct::Scratch> pairs;
    for (int i = 0; i < kColumnBlock / 2; ++i) pairs.emplace_back(h);
    std::vector<float> gain_a(static_cast<size_t>(h)), gain_b(gain_a);
    for (int part = range.begin(); part < range.end(); ++part) {
      const int channel = part / blocks, x0 = part % blocks * kColumnBlock, n = std::min(kColumnBlock, w - x0);
      float* const first = work + size_t(channel) * w + x0;
      for (int y = 0; y < h; ++y) {
        const float* const from = first + size_t(y) * row;
        const int place = column_.place(y);
        for (int x = 0; x < n; x += 2) pairs[x / 2].time[place] = {from[x], x + 1 < n ? from[x + 1] : 0.0f};
      }
      for (int x = 0; x < n; x += 2) {
        // The transform along the row has doubled the sum.
        const double sum = x0 + x == 0 && sums ? 2.0 * sums[channel] : Dct::kUnknownSum;
        gains(x0 + x, &gain_a);
        gains(x0 + x + 1, &gain_b);
        column_.filter(gain_a.data(), gain_b.data(), sum, &pairs[x / 2]);
      }
      for (int y = 0; y < h; ++y) {
        float* const to = first + size_t(y) * row;
        const int place = column_.place(y);
        for (int x = 0; x < n; x += 2) {
          const std::complex<float> pair = pairs[x / 2].time[place];
          to[x] = pair.real();
          if (x + 1 < n) to[x + 1] = pair.imag();
        }
      }
    }
  });
}

void PoissonDct::rows_inverse(int channels, const TakeRow& take, float* work) const {
  const int w = width();
  for_row_pairs(w, height(), channels, work, [&](int y, float* a, float* b, bool both, Dct::Scratch* scratch) {
    for (int c = 0; c < channels; ++c) row_.inverse(a + size_t(c) * w, b + size_t(c) * w, scratch);
    take(y, a);
    if (both) take(y + 1, b);
  });
}

}  // namespace gradus::reconstruct
