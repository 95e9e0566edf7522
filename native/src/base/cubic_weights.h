// Weights for cubic interpolation between equidistant samples.
#pragma once

#include <array>

namespace gradus {

// Returns the Catmull-Rom weights of the samples at -1, 0, 1 and 2 for the position 0 <= u < 1 (Keys 1981, "Cubic
// convolution interpolation for digital image processing", equation 15).
inline std::array<float, 4> cubic_weights(float u) {
  return {u * (-0.5f + u * (1.0f - 0.5f * u)), 1.0f + u * u * (-2.5f + 1.5f * u), u * (0.5f + u * (2.0f - 1.5f * u)),
          u * u * (-0.5f + 0.5f * u)};
}

}  // namespace gradus
