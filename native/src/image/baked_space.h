// A colour space given by values: one curve for all channels, then a matrix.
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
  // Linear between samples over [0, 1]; the first and last segments go on outside.
  float curve(float x) const;

  std::vector<float> curve_;
  float matrix_[9];
};

}  // namespace gradus::image
