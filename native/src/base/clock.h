// Clocks: wall time, CPU time of a thread and of the process; memory of the process.
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>

namespace gradus {

class WallClock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

inline uint64_t cpu_nanoseconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return uint64_t(t.tv_sec) * 1000000000u + uint64_t(t.tv_nsec);
}

inline uint64_t thread_cpu_nanoseconds() { return cpu_nanoseconds(CLOCK_THREAD_CPUTIME_ID); }
inline uint64_t process_cpu_nanoseconds() { return cpu_nanoseconds(CLOCK_PROCESS_CPUTIME_ID); }

// Largest resident size of the process so far, in bytes; 0 where the system does not tell.
uint64_t peak_memory_bytes();
// Physical memory of the machine, in bytes; 0 where the system does not tell.
uint64_t machine_memory_bytes();

}  // namespace gradus
