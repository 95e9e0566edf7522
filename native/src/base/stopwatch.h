// Wall time with pauses.
#pragma once

#include "base/clock.h"

namespace gradus {

// Stands still until it is started.
class Stopwatch {
 public:
  void start() {
    running_ = WallClock();
    is_running_ = true;
  }
  void stop() {
    before_ = seconds();
    is_running_ = false;
  }
  double seconds() const { return before_ + (is_running_ ? running_.seconds() : 0.0); }

 private:
  WallClock running_;
  bool is_running_ = false;
  double before_ = 0.0;
};

}  // namespace gradus
