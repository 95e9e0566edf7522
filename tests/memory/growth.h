// Tests that an operation which is repeated many times leaks no memory, file descriptors or threads.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "memory/allocations.h"

namespace gradus::memory {

// Maximum number of threads that may start after the warm-up. Embree's task scheduler starts its workers, at most one
// per core, when it first has work for them.
inline int late_workers() { return int(std::thread::hardware_concurrency()); }

// Runs body(i) `count` times, after a tenth as many runs as a warm-up. Expects that the number of allocations and file
// descriptors does not grow, that the number of threads grows by no more than late_workers(), and that resident memory
// grows by at most 4 MB plus `pools` bytes, which allow for the memory pools of the allocators.
template <class Body>
void expect_no_growth(int count, uint64_t pools, const Body& body) {
  for (int i = 0; i < count / 10; ++i) body(i);
  const uint64_t resident = resident_bytes();
  const int files = descriptors(), workers = threads();
  const int64_t pieces = live();
  for (int i = 0; i < count; ++i) body(count / 10 + i);
  EXPECT_LE(live(), pieces);  // may fall, because Embree's threads free their start data when they first run
  EXPECT_EQ(descriptors(), files);
  EXPECT_LE(threads(), workers + late_workers());
  const uint64_t now = resident_bytes();
  EXPECT_LE(now, resident + (4u << 20) + pools);
  std::printf("  %d times: %+.2f MB\n", count, 1e-6 * (double(now) - double(resident)));
}

// Returns the bytes by which allocators' pools may grow in `count` runs. When several threads allocate at once, the
// pools grow rarely, by about 5 MB at a time, up to a limit (8 MB after 12,000 renders).
inline uint64_t pools_of(int count) { return std::min<uint64_t>(uint64_t(count) * 8192, 16u << 20); }

}  // namespace gradus::memory
