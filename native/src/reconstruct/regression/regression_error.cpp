#include "reconstruct/regression/regression_error.h"

#include <algorithm>

#include "base/fault.h"
#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

// The values below were chosen by measurement: docs/method.md, "Regression on features".
//
// The light of a pixel is the mean over 3×3 pixels. With its own light alone, the estimated error of a dark pixel
// beside a bright one would fall as its true error rises.
constexpr int kErrorLightRadius = 1;
// Squared noise is averaged over this radius, because a single square is a poor estimate.
constexpr int kErrorNoiseRadius = 3;
// Radius of the window in which the sampled and the regressed image should have the same mean.
constexpr int kLostRadius = 8;

// Returns the squared loss of light around each pixel, minus what noise contributes to it, over the squared light
// there.
Field lost_share(const Smoothed& smoothed) {
  const int w = smoothed.mean.width(), h = smoothed.mean.height();
  Field terms(w, h, 3);
  for_values(&terms, [&](float& value, int x, int y, int c) {
    const float light = std::max(mean_of(smoothed.image, x, y), 0.0f), noise = mean_of(smoothed.half_difference, x, y);
    value = c == 0 ? mean_of(smoothed.mean, x, y) - mean_of(smoothed.image, x, y) : c == 1 ? noise * noise : light;
  });
  terms = box_mean(terms, kLostRadius);
  return make_field(w, h, [&](int x, int y) {
    const float lost = terms.row(y, 0)[x], light = terms.row(y, 2)[x] + kDark;
    return std::max(lost * lost -
                        terms.row(y, 1)[x] / float(count_within(x, kLostRadius, w) * count_within(y, kLostRadius, h)),
                    0.0f) /
           (light * light);
  });
}

// Returns the mean squared noise around each pixel, relative to the light: the noise of a light source says nothing
// about the wall beside it.
Field relative_noise(const Field& noise, const Field& light) {
  return box_mean(make_field(light.width(), light.height(),
                             [&](int x, int y) {
                               const float by =
                                   GRADUS_FAULT(error_noise_not_relative_to_light) ? 1.0f : light.row(y)[x];
                               return mean_of_squares(noise, x, y) / by;
                             }),
                  kErrorNoiseRadius);
}

}  // namespace

RegressionError::RegressionError(const Smoothed& smoothed, const Field& bias)
    : image_(smoothed.image),
      bias_(bias),
      light_(squared_light(smoothed.image, kErrorLightRadius)),
      lost_(lost_share(smoothed)),
      noise_(relative_noise(smoothed.noise, light_)) {}

Field RegressionError::of(ErrorUse use) const {
  const bool is_delivered = use == ErrorUse::Delivered;
  Field error = noise_;
  for_values(&error, [&](float& value, int x, int y, int) {
    const float own = std::max(mean_of(image_, x, y), 0.0f) + kDark,
                of_lost = GRADUS_FAULT(error_omits_lost_light) ? 0.0f
                          : is_delivered                       ? kLostDelivered * own * own / light_.row(y)[x]
                                                               : kLost,
                minimum = GRADUS_FAULT(error_includes_negative_bias) ? -kInfinity : 0.0f,
                of_bias = GRADUS_FAULT(error_omits_bias) ? 0.0f : std::max(bias_.row(y)[x], minimum);
    value = light_.row(y)[x] * (kHidden * value + of_lost * lost_.row(y)[x]) + of_bias;
  });
  return error;
}

}  // namespace gradus::reconstruct
