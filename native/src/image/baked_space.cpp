#include "image/baked_space.h"

#include <algorithm>

#include "base/error.h"

namespace gradus::image {

BakedSpace::BakedSpace(const GradusColorSpace& space) {
  if (space.curve_count == 1 || (space.curve_count > 1 && space.curve == nullptr)) {
    throw invalid_argument("colour space: a curve needs at least two samples");
  }
  curve_.assign(space.curve, space.curve + space.curve_count);
  std::copy(space.matrix, space.matrix + 9, matrix_);
  const bool finite = std::all_of(curve_.begin(), curve_.end(), [](float x) { return is_finite(x); }) &&
                      std::all_of(matrix_, matrix_ + 9, [](float x) { return is_finite(x); });
  if (!finite) {
    throw invalid_argument("colour space: a value is not finite");
  }
}

float BakedSpace::curve(float x) const {
  if (curve_.empty()) {
    return x;
  }
  const float position = x * static_cast<float>(curve_.size() - 1);
  const float last = static_cast<float>(curve_.size() - 2);
  // The clamped index makes values beyond the ends continue the first or the last segment. A NaN stays a NaN.
  const size_t i = position > 0.0f ? static_cast<size_t>(std::min(position, last)) : 0;
  return curve_[i] + (curve_[i + 1] - curve_[i]) * (position - static_cast<float>(i));
}

Rgb BakedSpace::apply(const Rgb& encoded) const {
  const Rgb c(curve(encoded.x), curve(encoded.y), curve(encoded.z));
  const float* m = matrix_;
  return Rgb(m[0] * c.x + m[1] * c.y + m[2] * c.z, m[3] * c.x + m[4] * c.y + m[5] * c.z,
             m[6] * c.x + m[7] * c.y + m[8] * c.z);
}

}  // namespace gradus::image
