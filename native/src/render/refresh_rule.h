// Decides when the preview is reconstructed again: so rarely that it takes a twentieth of the time, and up to a quarter
// for the first one of a short render.
//
// All times are wall-clock times, because these are what the user waits for, with any number of threads. CPU time of
// the process would include work of the host.
#pragma once

#include <algorithm>

namespace gradus::render {

class RefreshRule {
 public:
  // Time between two previews, in multiples of the time of one.
  static constexpr double kTimes = 20.0;
  // Maximum time before the first preview, in the same unit. It is shorter, because the first full-size image matters
  // more than further ones.
  static constexpr double kFirstTimes = 4.0;

  // Sets the expected time of the first preview. Without this call it is 0.
  void expect(double seconds) { cost_ = seconds; }

  // Returns whether a preview is due. `sampled` is the time of sampling so far in seconds, `fraction` the share of all
  // samples that were taken in it. The first preview comes earlier if the render will be long enough for it.
  bool is_due(double sampled, double fraction) const {
    return is_first_ ? sampled >= cost_ * std::min(kFirstTimes, kTimes * fraction) : sampled - last_ >= kTimes * cost_;
  }

  // Records a preview that ended after `sampled` seconds of sampling and took `seconds`.
  void done(double sampled, double seconds) {
    last_ = sampled;
    cost_ = seconds;
    is_first_ = false;
  }

 private:
  double cost_ = 0.0;
  double last_ = 0.0;  // seconds of sampling when the last preview ended
  bool is_first_ = true;
};

}  // namespace gradus::render
