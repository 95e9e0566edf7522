// Whether what is done again and again leaves something behind.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "memory/allocations.h"

namespace gradus::memory {

// The scheduler beneath Embree starts its workers, at most one per core, when there first is work for one to take: it
// may be after the warm-up.
inline int late_workers() { return int(std::thread::hardware_concurrency()); }

// Runs body(i) `count` times after a tenth of it as a warm-up. Nothing is kept; descriptors stay, and threads but for
// late workers. RSS may grow by 4 MB, and by the pools of the allocators.
template <class Body>
void expect_no_growth(int count, uint64_t pools, const Body& body) {
  for (int i = 0; i < count / 10; ++i) body(i);
  const uint64_t resident = resident_bytes();
  const int files = descriptors(), workers = threads();
  const int64_t pieces = live();
  for (int i = 0; i < count; ++i) body(count / 10 + i);
  EXPECT_LE(live(), pieces);  // Embree's threads give back what started them when they come to run
  EXPECT_EQ(descriptors(), files);
  EXPECT_LE(threads(), workers + late_workers());
  const uint64_t now = resident_bytes();
  EXPECT_LE(now, resident + (4u << 20) + pools);
  std::printf("  %d times: %+.2f MB\n", count, 1e-6 * (double(now) - double(resident)));
}

// Where threads meet in them, the pools grow in steps of some 5 MB, seldom, and end (12,000 renders: 8 MB).
inline uint64_t pools_of(int count) { return std::min<uint64_t>(uint64_t(count) * 8192, 16u << 20); }

}  // namespace gradus::memory
