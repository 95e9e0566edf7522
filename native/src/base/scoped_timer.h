// What a part of the work costs.
#pragma once

#include <cstdint>

#include "base/clock.h"

namespace gradus {

// Adds what passes while it lives: wall time, and CPU time of the whole process.
class ScopedTimer {
 public:
  ScopedTimer(double* seconds, double* cpu_seconds) : seconds_(seconds), cpu_seconds_(cpu_seconds) {}
  ~ScopedTimer() {
    *seconds_ += clock_.seconds();
    *cpu_seconds_ += 1e-9 * double(process_cpu_nanoseconds() - cpu_);
  }
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;

 private:
  double *const seconds_, *const cpu_seconds_;
  const WallClock clock_;
  const uint64_t cpu_ = process_cpu_nanoseconds();
};

}  // namespace gradus
