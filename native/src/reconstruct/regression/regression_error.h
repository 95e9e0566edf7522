// Estimated squared errors of the regression on features. Each is the sum of the remaining noise, the bias of the
// windows, and the lost light.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Factor on the remaining noise. The weights follow the noise and hide about a third of its variance from the regressed
// half difference.
inline constexpr float kHidden = 1.7f;
// Factor on the squared light that is lost where the means of the sampled and the regressed image differ: rare bright
// samples lie in few of those pixels.
inline constexpr float kLost = 0.3f;
// Factor on the squared lost light in the error that is delivered. There, lost light is a share of the pixel's own
// light: relative to the mean of 3×3 pixels, dark pixels beside a highlight raised the error of a picture to eight
// times the true one. The error that weighs pixels and stops pixel blocks keeps kLost, because pictures depend on it.
inline constexpr float kLostDelivered = 0.1f;

// Input and output of the regression, three channels each.
struct Smoothed {
  const Field &mean, &half_difference;  // sampled mean of the half-buffers, and half their difference
  const Field &image, &noise;           // the regression of `mean` and of `half_difference`
};

// What the error is for.
enum class ErrorUse { Weights, Delivered };

// The squared error, mean over the channels, as one channel.
class RegressionError {
 public:
  // Computes the terms that all uses share. `bias` is the squared bias of the windows as estimated from their
  // residuals; single values may be negative. The image and `bias` must outlive the object.
  RegressionError(const Smoothed& smoothed, const Field& bias);

  Field of(ErrorUse use = ErrorUse::Weights) const;

 private:
  const Field &image_, &bias_;
  Field light_, lost_, noise_;
};

}  // namespace gradus::reconstruct
