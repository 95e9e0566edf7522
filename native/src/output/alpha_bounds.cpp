#include "output/alpha_bounds.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/rows.h"

namespace gradus::output {
namespace {

// What all samples of a pixel, or of a square of pixels, show.
enum class Coverage : uint8_t { Mixed, Empty, Opaque };

constexpr float kRounding = 1e-5f;  // error of a sum of alpha, relative to the number of samples
constexpr int kLargestRadius = 4;   // of squares, in pixels
constexpr float kMissed = 3.0f;     // −ln 0.05: samples of what n samples miss, with a confidence of 95 %

Coverage coverage_of(const film::Film& film, size_t pixel) {
  const auto samples = float(film::samples_at(film, pixel));
  float sum = 0.0f;
  for (const film::ComponentPlanes& component : film.components)
    sum += component.primal[0][pixel].w + component.primal[1][pixel].w;
  if (!(samples > 0.0f)) return Coverage::Mixed;
  if (std::fabs(sum) <= kRounding * samples) return Coverage::Empty;
  return std::fabs(sum - samples) <= kRounding * samples ? Coverage::Opaque : Coverage::Mixed;
}

// A value for each pixel of a film.
class CoverageMap {
 public:
  CoverageMap(int w, int h) : w_(w), h_(h), values_(size_t(w) * size_t(h)) {}

  // Sets all values to those of value(x, y).
  template <class Value>
  void fill(const Value& value) {
    for_rows(h_, [&](int y) {
      for (int x = 0; x < w_; ++x) values_[index(x, y)] = value(x, y);
    });
  }
  Coverage at(int x, int y) const { return values_[index(x, y)]; }
  // Returns the value that all 3×3 pixels around one have, or Mixed. Pixels beyond the border count as equal.
  Coverage of_square(int x, int y) const {
    const Coverage own = at(x, y);
    for (int j = std::max(y - 1, 0); j <= std::min(y + 1, h_ - 1); ++j) {
      for (int i = std::max(x - 1, 0); i <= std::min(x + 1, w_ - 1); ++i) {
        if (at(i, j) != own) return Coverage::Mixed;
      }
    }
    return own;
  }

 private:
  size_t index(int x, int y) const { return size_t(y) * size_t(w_) + size_t(x); }

  int w_, h_;
  std::vector<Coverage> values_;
};

AlphaBounds bounds_of(Coverage coverage, float samples) {
  const float missed = std::min(kMissed / samples, 1.0f);
  return coverage == Coverage::Opaque ? AlphaBounds{1.0f - missed, 1.0f} : AlphaBounds{0.0f, missed};
}

}  // namespace

std::vector<AlphaBounds> find_alpha_bounds(const film::Film& film) {
  const int w = film.region.width(), h = film.region.height();
  const auto index = [w](int x, int y) { return size_t(y) * size_t(w) + size_t(x); };
  std::vector<AlphaBounds> bounds(size_t(film.region.area()));
  CoverageMap smaller(w, h), squares(w, h);
  squares.fill([&](int x, int y) { return coverage_of(film, index(x, y)); });
  for (int radius = 1; radius <= kLargestRadius; ++radius) {
    std::swap(smaller, squares);
    squares.fill([&](int x, int y) { return smaller.of_square(x, y); });
    const auto pixels = float((2 * radius + 1) * (2 * radius + 1));
    for_rows(h, [&](int y) {
      for (int x = 0; x < w; ++x) {
        const size_t i = index(x, y);
        if (squares.at(x, y) == Coverage::Mixed) continue;
        bounds[i] = bounds_of(squares.at(x, y), pixels * float(film::samples_at(film, i)));
      }
    });
  }
  return bounds;
}

}  // namespace gradus::output
