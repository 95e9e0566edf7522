#include "motion/flow_levels.h"

#include <algorithm>
#include <cmath>

#include "motion/film_plane.h"

namespace gradus::motion {
namespace {

constexpr float kFloor = 0.01f;         // share of the mean that is added before the logarithm: values below are black
constexpr float kOutliers = 0.002f;     // share of pixels beyond each end of the scale
constexpr float kMinLogarithms = 0.5f;  // minimum range of the scale in the logarithmic domain
constexpr float kMinShare = 0.25f;      // minimum range of the scale in the linear domain, as a share of the mean
constexpr float kBrightest = 1e30f;

using Values = std::vector<float>;

// Returns the luminance, clamped to a finite range; 0 if it is not finite.
float tamed(const Rgb& radiance) {
  const float value = luminance(radiance);
  return is_finite(value) ? std::clamp(value, -kBrightest, kBrightest) : 0.0f;
}

// Returns the mean magnitude of the values of both frames. rows: twice the height of the film.
float mean_magnitude(const Values& values, int width, int rows) {
  const Sums sums = sum_rows(rows, 1, [&](int y, int) {
    double sum = 0.0;
    for (size_t i = size_t(y) * size_t(width); i < size_t(y + 1) * size_t(width); ++i) sum += std::abs(values[i]);
    return sum;
  });
  return values.empty() ? 0.0f : float(sums[0] / double(values.size()));
}

struct Scale {
  float low, high;
};

// Returns the range of the values without outliers.
Scale scale_of(Values values) {
  const auto place = [&](float share) {
    return values.begin() + ptrdiff_t(std::lround(share * float(values.size() - 1)));
  };
  const auto lower = place(kOutliers), upper = place(1.0f - kOutliers);
  std::nth_element(values.begin(), lower, values.end());
  const float low = *lower;
  std::nth_element(lower, upper, values.end());
  return {low, *upper};
}

}  // namespace

std::array<GreyImage, 2> flow_levels(int width, int height, std::span<const Rgb> first, std::span<const Rgb> second,
                                     FlowDomain domain) {
  const size_t count = first.size();
  Values values(2 * count);
  each_pixel(width, height, [&](int, int, size_t p) {
    values[p] = tamed(first[p]);
    values[count + p] = tamed(second[p]);
  });
  const float mean = mean_magnitude(values, width, 2 * height);
  std::array<GreyImage, 2> result{GreyImage{width, height, Values(count)}, GreyImage{width, height, Values(count)}};
  if (mean == 0.0f) return result;
  if (domain == FlowDomain::Logarithmic) {
    each_pixel(width, 2 * height,
               [&](int, int, size_t p) { values[p] = std::log(std::max(values[p], 0.0f) / mean + kFloor); });
  }
  const auto [low, high] = scale_of(values);
  const float minimum = domain == FlowDomain::Logarithmic ? kMinLogarithms : kMinShare * mean;
  const float scale = 255.0f / std::max(high - low, minimum);
  each_pixel(width, height, [&, low = low](int, int, size_t p) {
    for (size_t k = 0; k < 2; ++k)
      result[k].levels[p] = std::clamp((values[k * count + p] - low) * scale, 0.0f, 255.0f);
  });
  return result;
}

}  // namespace gradus::motion
