#include "motion/flow_levels.h"

#include <algorithm>
#include <cmath>

namespace gradus {
namespace {

constexpr float kFloor = 0.01f;           // of the mean, added before the logarithm: below it is black
constexpr float kOutliers = 0.002f;       // share of pixels beyond each end of the scale
constexpr float kLeastLogarithms = 0.5f;  // that the scale spans
constexpr float kLeastShare = 0.25f;      // of the mean that the scale spans in the linear domain
constexpr float kBrightest = 1e30f;

using Values = std::vector<float>;

float tamed(const Rgb& radiance) {
  const float value = luminance(radiance);
  return is_finite(value) ? std::clamp(value, -kBrightest, kBrightest) : 0.0f;
}

float mean_magnitude(const Values& values) {
  double sum = 0.0;
  for (const float value : values) sum += std::abs(value);
  return values.empty() ? 0.0f : float(sum / double(values.size()));
}

float quantile(Values values, float share) {
  const auto at = values.begin() + ptrdiff_t(std::lround(share * float(values.size() - 1)));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

std::array<GreyImage, 2> flow_levels(int width, int height, std::span<const Rgb> first, std::span<const Rgb> second, FlowDomain domain) {
  const size_t count = first.size();
  Values values;
  values.reserve(2 * count);
  for (const Rgb& radiance : first) values.push_back(tamed(radiance));
  for (const Rgb& radiance : second) values.push_back(tamed(radiance));
  const float mean = mean_magnitude(values);
  std::array<GreyImage, 2> result{GreyImage{width, height, Values(count)}, GreyImage{width, height, Values(count)}};
  if (mean == 0.0f) return result;
  if (domain == FlowDomain::Logarithmic) {
    for (float& value : values) value = std::log(std::max(value, 0.0f) / mean + kFloor);
  }
  const float low = quantile(values, kOutliers), high = quantile(values, 1.0f - kOutliers);
  const float least = domain == FlowDomain::Logarithmic ? kLeastLogarithms : kLeastShare * mean;
  const float scale = 255.0f / std::max(high - low, least);
  for (size_t i = 0; i < values.size(); ++i) result[i / count].levels[i % count] = std::clamp((values[i] - low) * scale, 0.0f, 255.0f);
  return result;
}

}  // namespace gradus
