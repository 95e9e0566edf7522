#include "base/clock.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

namespace gradus::clock_test {
namespace {

constexpr uint64_t kMillisecond = 1000000;

void work_for(uint64_t nanoseconds) {
  const uint64_t begin = thread_cpu_nanoseconds();
  while (thread_cpu_nanoseconds() - begin < nanoseconds) {
  }
}

TEST(ScopedThreadTimer, AddsTheTimeOfItsThread) {
  std::atomic<uint64_t> counter{0};
  for (int i = 0; i < 2; ++i) {
    const ScopedThreadTimer timer(&counter);
    work_for(5 * kMillisecond);
  }
  EXPECT_GE(counter.load(), 10 * kMillisecond);
}

TEST(ScopedThreadTimer, LeavesOutOtherThreads) {
  std::atomic<uint64_t> counter{0};
  {
    const ScopedThreadTimer timer(&counter);
    std::thread other([] { work_for(50 * kMillisecond); });
    other.join();
  }
  EXPECT_LT(counter.load(), 25 * kMillisecond);
}

}  // namespace
}  // namespace gradus::clock_test
