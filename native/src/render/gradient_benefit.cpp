#include "render/gradient_benefit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace gradus::render {

namespace {

// Error that the model leaves out because it supposes the same noise everywhere: the error measured on twelve scenes is
// 0 to 0.3 above that of the model, 0.1 in the median.
constexpr double kUneven = 0.1;

// Correction for outliers, which roots of deviations hardly count. Shifts reduce outliers no better than the rest, and
// often less: by mean squares of many more samples, L2 leaves 1 to 5 times the share that roots predict, 1.8 in the
// median of twelve scenes.
constexpr double kOutliers = 1.35;

// CPU time of the offset paths over that of base paths: a constant for the paths themselves, and the time of each of
// their rays per ray of the base path, shading included. Least squares over twelve scenes, within 10 % on eleven.
constexpr double kOffsetPaths = 0.36, kShiftRay = 0.50, kShiftShadowRay = 0.55;

// Added to the squared brightness, as in the stopping rule: noise in areas darker than this is not visible.
constexpr double kDark = 1e-3;

// A partial choice of blocks must reach this share of the result of all or no blocks. The minimum over many uncertain
// sums tends to be one that was estimated too low.
constexpr double kWorthParting = 0.75;

double squared(double x) { return x * x; }

// Returns the share of the variance that L2 leaves, by roots of deviations and at the best of the weights. It includes
// all correlation between pixels and differences.
double l2_share(const PilotSums& sums) {
  return squared(squared(*std::min_element(sums.l2_roots.begin(), sums.l2_roots.end()) / sums.pixel_root));
}

// Returns the benefit without its `error`.
Benefit known_benefit(const PilotSums& sums) {
  Benefit benefit;
  if (sums.plain_rays > 0.0) {
    benefit.cost +=
        kOffsetPaths + (kShiftRay * sums.shift_rays + kShiftShadowRay * sums.shift_shadow_rays) / sums.plain_rays;
  }
  if (!(sums.pixels > 0.0)) return benefit;
  benefit.rays = sums.plain_rays / sums.pixels;
  benefit.noise = squared(squared(sums.pixel_root / sums.pixels)) / (squared(sums.brightness / sums.pixels) + kDark);
  benefit.noisy = sums.pixel_deviation > 0.0 && sums.differences > 0.0;
  return benefit;
}

}  // namespace

void PilotSums::add(const PilotSums& other, double weight) {
  pixels += weight * other.pixels;
  brightness += weight * other.brightness;
  pixel_deviation += weight * other.pixel_deviation;
  differences += weight * other.differences;
  difference_deviation += weight * other.difference_deviation;
  pixel_root += weight * other.pixel_root;
  for (size_t i = 0; i < kPilotAlphas; ++i) l2_roots[i] += weight * other.l2_roots[i];
  plain_rays += weight * other.plain_rays;
  shift_rays += weight * other.shift_rays;
  shift_shadow_rays += weight * other.shift_shadow_rays;
}

double reconstructed_variance(double ratio) {
  const double k = 4.0 * ratio / (1.0 + 4.0 * ratio);
  return 2.0 / std::numbers::pi * std::comp_ellint_1(k) / (1.0 + 4.0 * ratio);
}

Benefit estimate_benefit(const PilotSums& sums) {
  Benefit benefit = known_benefit(sums);
  if (!benefit.noisy) return benefit;
  const double pixel = sums.pixel_deviation / sums.pixels, difference = sums.difference_deviation / sums.differences;
  const double independent = kUneven + (difference > 0.0 ? reconstructed_variance(squared(pixel / difference)) : 0.0);
  benefit.error = std::max(independent, l2_share(sums));
  return benefit;
}

Benefit estimate_benefit_for_l2(const PilotSums& sums) {
  Benefit benefit = known_benefit(sums);
  if (benefit.noisy) benefit.error = kOutliers * l2_share(sums);
  return benefit;
}

std::vector<bool> choose_blocks(const std::vector<Benefit>& blocks, const std::vector<double>& pixels) {
  double error = 0.0, cost = 0.0;
  std::vector<double> gain, extra;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const Benefit& b = blocks[i];
    error += b.noise * pixels[i];
    cost += b.rays * pixels[i];
    gain.push_back((1.0 - b.error) * b.noise * pixels[i]);
    extra.push_back((b.cost - 1.0) * b.rays * pixels[i]);
  }
  std::vector<size_t> order(blocks.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto worth = [&](size_t i) { return extra[i] > 0.0 ? gain[i] / extra[i] : gain[i] > 0.0 ? HUGE_VAL : 0.0; };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return worth(a) > worth(b); });
  const double none = error * cost;
  double minimum = none;
  size_t best = 0;
  for (size_t n = 0; n < order.size(); ++n) {
    error -= gain[order[n]];
    cost += extra[order[n]];
    if (error * cost < minimum) {
      minimum = error * cost;
      best = n + 1;
    }
  }
  // Now `error` and `cost` are the sums with gradients in all blocks.
  const double all = error * cost;
  if (minimum > kWorthParting * std::min(all, none)) best = all < none ? blocks.size() : 0;
  std::vector<bool> chosen(blocks.size(), false);
  for (size_t n = 0; n < best; ++n) chosen[order[n]] = true;
  return chosen;
}

}  // namespace gradus::render
