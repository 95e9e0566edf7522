// Estimated squared error of the regression on features: what is left of the noise, the windows' bias, and light that
// was lost.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// The weights follow the noise, and hide a third of its variance from what they leave of half the difference.
inline constexpr float kHidden = 1.7f;
// Share of pixels' squared light that is lost where what went in and what came out differ: rare bright samples lie in
// few of them.
inline constexpr float kLost = 0.3f;

// Three channels each.
struct Smoothed {
  const Field &mean, &half_difference;  // what there was, and half the difference of its halves
  const Field &image, &noise;           // what became of both
};

// Mean over the channels, one channel. bias: squared, of windows, as far as their residuals tell; single values may be
// below 0.
Field regression_error(const Smoothed& smoothed, const Field& bias);

}  // namespace gradus::reconstruct
