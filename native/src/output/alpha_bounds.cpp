#include "output/alpha_bounds.h"

#include <algorithm>
#include <cmath>

#include "film/pixel_sum.h"
#include "reconstruct/field_values.h"

namespace gradus::output {
namespace {

using reconstruct::Field;

constexpr float kRounding = 1e-5f;  // error of a sum of alpha, relative to the number of samples
constexpr int kLargestRadius = 4;   // of squares, in pixels
constexpr float kMissed = 3.0f;     // −ln 0.05: samples of what n samples miss, with a confidence of 95 %
constexpr float kMixed = 0.5f;      // common alpha of samples that differ

// Returns the alpha that all samples of a pixel have, 0 or 1, or kMixed.
float common_alpha(const film::Film& film, size_t pixel) {
  const auto samples = float(film::samples_at(film, pixel));
  if (!(samples > 0.0f)) return kMixed;
  const float sum = film::sum_at(film, pixel).w, error = kRounding * samples;
  if (std::fabs(sum) <= error) return 0.0f;
  return std::fabs(sum - samples) <= error ? 1.0f : kMixed;
}

// Returns the value that 3×3 pixels have in common, or kMixed. Pixels beyond the border count as equal.
float common_value(const Field& values, int x, int y) {
  const float own = values.row(y)[x];
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, values.height() - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, values.width() - 1); ++i) {
      if (values.row(j)[i] != own) return kMixed;
    }
  }
  return own;
}

AlphaBounds bounds_of(float alpha, float samples) {
  const float missed = std::min(kMissed / samples, 1.0f);
  return alpha == 1.0f ? AlphaBounds{1.0f - missed, 1.0f} : AlphaBounds{0.0f, missed};
}

}  // namespace

std::vector<AlphaBounds> find_alpha_bounds(const film::Film& film) {
  const int w = film.region.width(), h = film.region.height();
  const auto index = [w](int x, int y) { return size_t(y) * size_t(w) + size_t(x); };
  std::vector<AlphaBounds> bounds(size_t(film.region.area()));
  Field common = reconstruct::make_field(w, h, [&](int x, int y) { return common_alpha(film, index(x, y)); });
  for (int radius = 1; radius <= kLargestRadius; ++radius) {
    common = reconstruct::make_field(w, h, [&](int x, int y) { return common_value(common, x, y); });
    const int side = 2 * radius + 1;
    for_values(&common, [&](float alpha, int x, int y, int) {
      const size_t i = index(x, y);
      if (alpha != kMixed) bounds[i] = bounds_of(alpha, float(side * side) * float(film::samples_at(film, i)));
    });
  }
  return bounds;
}

}  // namespace gradus::output
