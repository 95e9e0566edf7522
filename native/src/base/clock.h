// Clocks for wall time and CPU time, timers built on them, and the memory of the process and the machine.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <ctime>

namespace gradus {

// Measures the wall time since its construction, in seconds.
class WallClock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Returns the time of a POSIX clock in nanoseconds, with the clock's own origin.
inline uint64_t cpu_nanoseconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return uint64_t(t.tv_sec) * 1000000000u + uint64_t(t.tv_nsec);
}

inline uint64_t thread_cpu_nanoseconds() { return cpu_nanoseconds(CLOCK_THREAD_CPUTIME_ID); }
inline uint64_t process_cpu_nanoseconds() { return cpu_nanoseconds(CLOCK_PROCESS_CPUTIME_ID); }

// Adds its own lifetime to two counters: wall time, and CPU time of the whole process, both in seconds.
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

// Adds the CPU time that its thread takes during its lifetime to a counter, in nanoseconds. Other threads may add to
// the same counter.
class ScopedThreadTimer {
 public:
  explicit ScopedThreadTimer(std::atomic<uint64_t>* nanoseconds) : nanoseconds_(nanoseconds) {}
  ~ScopedThreadTimer() { *nanoseconds_ += thread_cpu_nanoseconds() - start_; }
  ScopedThreadTimer(const ScopedThreadTimer&) = delete;
  ScopedThreadTimer& operator=(const ScopedThreadTimer&) = delete;

 private:
  std::atomic<uint64_t>* const nanoseconds_;
  const uint64_t start_ = thread_cpu_nanoseconds();
};

// Measures wall time with pauses. It does not run until start() is called.
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

// Returns the largest resident size of the process so far in bytes, or 0 if the system does not report it.
uint64_t peak_memory_bytes();
// Returns the physical memory of the machine in bytes, or 0 if the system does not report it.
uint64_t machine_memory_bytes();

}  // namespace gradus
