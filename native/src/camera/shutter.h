// When the shutter is open, and the choice of a moment.
#pragma once

#include <vector>

#include "gradus/gradus.h"

namespace gradus::camera {

// Times of rays run from 0, the opening, to 1, the closing.
class Shutter {
 public:
  Shutter() = default;
  // Of GradusCamera's fields. Closed for good (a frame is a moment) where they are not finite or the curve is 0
  // everywhere.
  explicit Shutter(const GradusCamera& desc);

  bool opens() const { return close_ > open_; }
  // The moment of u in [0, 1): its density is the curve, linear between its values.
  float sample(float u) const;
  // Frames relative to the one rendered.
  float frame_time(float time) const { return open_ + (close_ - open_) * time; }
  // The time that is nearest to the frame rendered.
  float time_of_frame() const;

 private:
  float open_ = 0.0f, close_ = 0.0f;
  std::vector<float>
      cumulative_;  // of the curve, at the end of each of its intervals, the last 1; empty: open all the time
  std::vector<float> curve_;
};

}  // namespace gradus::camera
