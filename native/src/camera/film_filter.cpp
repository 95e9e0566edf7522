#include "camera/film_filter.h"

#include <cmath>
#include <vector>

#include "gradus/gradus.h"

namespace gradus::camera {

namespace {

// Returns the filter at v in [-1/2, 1/2], in units of its support. The filters are those of Cycles: exp(-2 (6 v)²), and
// the four-term Blackman-Harris window.
double filter_value(uint32_t type, double v) {
  if (type == GRADUS_FILTER_GAUSSIAN) {
    return std::exp(-72.0 * v * v);
  }
  if (type == GRADUS_FILTER_BLACKMAN_HARRIS) {
    const double a = 2.0 * 3.14159265358979323846 * (v + 0.5);
    return 0.35875 - 0.48829 * std::cos(a) + 0.14128 * std::cos(2.0 * a) - 0.01168 * std::cos(3.0 * a);
  }
  return 1.0;
}

// Returns the full support in pixels. Cycles' width is a third of the Gaussian's support and half of Blackman-Harris's.
// Its box filter has no width.
double support(uint32_t type, float width) {
  switch (type) {
    case GRADUS_FILTER_GAUSSIAN:
      return 3.0 * width;
    case GRADUS_FILTER_BLACKMAN_HARRIS:
      return 2.0 * width;
    default:
      return 1.0;
  }
}

}  // namespace

FilmFilter::FilmFilter(uint32_t type, float width) {
  constexpr int fine = 16 * kCells;
  std::vector<double> cumulated(fine + 1, 0.0);
  for (int i = 0; i < fine; ++i) {
    cumulated[i + 1] = cumulated[i] + filter_value(type, (i + 0.5) / fine - 0.5);
  }
  const double full = support(type, width);
  int j = 0;
  for (int i = 0; i <= kCells; ++i) {
    const double target = cumulated[fine] * i / kCells;
    while (j < fine - 1 && cumulated[j + 1] < target) {
      ++j;
    }
    const double mass = cumulated[j + 1] - cumulated[j];
    const double inside = mass > 0.0 ? std::fmin(1.0, (target - cumulated[j]) / mass) : 0.0;
    inverse_[i] = static_cast<float>(((j + inside) / fine - 0.5) * full);
  }
}

float FilmFilter::sample_axis(float u) const {
  const float x = u * kCells;
  const int i = x < kCells - 1 ? static_cast<int>(x) : kCells - 1;
  const float f = x - static_cast<float>(i);
  return inverse_[i] + f * (inverse_[i + 1] - inverse_[i]);
}

}  // namespace gradus::camera
