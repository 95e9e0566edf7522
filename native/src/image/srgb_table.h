// The sRGB curve as a table, for look-ups of encoded texels.
#pragma once

#include <array>
#include <cstddef>

#include "base/lanes.h"
#include "image/color.h"

namespace gradus::image {

// The sRGB curve from a table with linear interpolation. It is exact in the linear segment of the curve; elsewhere its
// error is about 1e-6. Values outside [0, 1] take the formula.
class SrgbTable {
 public:
  SrgbTable() {
    for (size_t i = 0; i < values_.size(); i++) {
      values_[i] = srgb_to_linear(static_cast<float>(i) / kSteps);
    }
  }
  float operator()(float x) const {
    if (!is_inside(x)) {
      return srgb_to_linear(x);
    }
    const float position = x * kSteps;
    const size_t i = static_cast<size_t>(position);
    return values_[i] + (values_[i + 1] - values_[i]) * (position - static_cast<float>(i));
  }
  // Decodes eight values. The results are those of the function above, to the bit.
  FloatLanes operator()(FloatLanes x) const {
    const uint32_t inside = mask_of((SignedLanes)((x >= 0.0f) & (x <= 1.0f)));
    const FloatLanes position = (inside == kAllLanes ? x : minimum(maximum(x, FloatLanes{}), kLast)) * kSteps;
    const __m256i i = _mm256_cvttps_epi32((__m256)position);
    const auto low = (FloatLanes)_mm256_i32gather_ps(values_.data(), i, sizeof(float));
    const auto high = (FloatLanes)_mm256_i32gather_ps(values_.data() + 1, i, sizeof(float));
    FloatLanes decoded = low + (high - low) * (position - (FloatLanes)_mm256_cvtepi32_ps(i));
    for (int k = 0; inside != kAllLanes && k < kLanes; ++k) {
      if ((inside >> k & 1u) == 0) decoded[k] = srgb_to_linear(x[k]);
    }
    return decoded;
  }

 private:
  static constexpr float kSteps = 1024.0f;
  static constexpr uint32_t kAllLanes = (1u << kLanes) - 1;
  static constexpr FloatLanes kLast = FloatLanes{} + 1.0f;
  static bool is_inside(float x) { return x >= 0.0f && x <= 1.0f; }
  std::array<float, 1026> values_;
};

// Returns the table, which is made at the first call.
inline const SrgbTable& srgb_table() {
  static const SrgbTable table;
  return table;
}

}  // namespace gradus::image
