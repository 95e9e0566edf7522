// When what a watcher sees is reconstructed again: so seldom that it takes a twentieth of the time, of a short render a
// quarter once.
//
// Seconds are those of the wall. They are what the artist waits for, on any number of threads and however well either
// part uses them; CPU time of the process would hold what the host does besides.
#pragma once

#include <algorithm>

namespace gradus::render {

class RefreshRule {
 public:
  static constexpr double kTimes = 20.0;  // its own cost that passes between two
  static constexpr double kFirstTimes =
      4.0;  // and before the first at most: a picture in full is worth more than one more of them

  // What the first one should take. Unknown, it counts for nothing.
  void expect(double seconds) { cost_ = seconds; }

  // sampled: seconds of sampling so far; fraction: the share of all samples that they brought. The first one need not
  // wait until it is earned if the render will be long enough for it.
  bool is_due(double sampled, double fraction) const {
    return is_first_ ? sampled >= cost_ * std::min(kFirstTimes, kTimes * fraction) : sampled - last_ >= kTimes * cost_;
  }

  void done(double sampled, double seconds) {
    last_ = sampled;
    cost_ = seconds;
    is_first_ = false;
  }

 private:
  double cost_ = 0.0;
  double last_ = 0.0;  // seconds of sampling when it ended
  bool is_first_ = true;
};

}  // namespace gradus::render
