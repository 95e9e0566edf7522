#include <cmath>

#include "image/color.h"

namespace gradus::image {

float srgb_to_linear(float encoded) {
  if (encoded <= 0.04045f) {
    return encoded * (1.0f / 12.92f);
  }
  return std::pow((encoded + 0.055f) * (1.0f / 1.055f), 2.4f);
}

float linear_to_srgb(float linear) {
  if (linear <= 0.0031308f) {
    return linear * 12.92f;
  }
  return 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

}  // namespace gradus::image
