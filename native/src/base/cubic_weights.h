// Interpolation between samples by cubics.
#pragma once

#include <array>

namespace gradus {

// Of the samples -1, 0, 1 and 2 from the one before the position, 0 <= u < 1 from that: Catmull and Rom's (Keys 1981,
// "Cubic convolution interpolation for digital image processing", equation 15).
inline std::array<float, 4> cubic_weights(float u) {
  return {u * (-0.5f + u * (1.0f - 0.5f * u)), 1.0f + u * u * (-2.5f + 1.5f * u), u * (0.5f + u * (2.0f - 1.5f * u)),
          u * u * (-0.5f + 0.5f * u)};
}

}  // namespace gradus
