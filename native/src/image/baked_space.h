// A colour space that is defined by values: one curve for all channels, followed by a matrix.
#pragma once

#include <cstddef>
#include <vector>

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::image {

class BakedSpace {
 public:
  // Throws Error(INVALID_ARGUMENT) for values that are not finite.
  explicit BakedSpace(const GradusColorSpace& space);
  Rgb apply(const Rgb& encoded) const;

 private:
  // Interpolates the curve's samples over [0, 1] linearly. Outside it continues the first and the last segment.
  float curve(float x) const;

  std::vector<float> curve_;
  float matrix_[9];
};

}  // namespace gradus::image
