// The shutter interval and the sampling of times in it.
#pragma once

#include <vector>

#include "gradus/gradus.h"

namespace gradus::camera {

// The shutter of a camera. Shutter times run from 0 (opening) to 1 (closing).
class Shutter {
 public:
  Shutter() = default;
  // Reads the shutter fields of `desc`. If they are not finite, or if the curve is 0 everywhere, the interval is empty
  // and the frame shows a single moment.
  explicit Shutter(const GradusCamera& desc);

  // Returns whether the shutter interval has a length above 0.
  bool opens() const { return close_ > open_; }
  // Returns the shutter time for u in [0, 1). Its density is the curve, interpolated linearly between its values.
  float sample(float u) const;
  // Returns the shutter time that is nearest to the rendered frame.
  float time_of_frame() const;

 private:
  float open_ = 0.0f, close_ = 0.0f;
  // Cumulative distribution of the curve at the end of each of its intervals; the last value is 1. Empty without a
  // curve.
  std::vector<float> cumulative_;
  std::vector<float> curve_;
};

}  // namespace gradus::camera
