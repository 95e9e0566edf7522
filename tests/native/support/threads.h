// L1: the same bits for any number of threads.
#pragma once

#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace gradus::test {

template <class Compute>
void expect_same_bits_for_any_number_of_threads(Compute&& compute) {
  const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, 8);
  decltype(compute()) first;
  for (const int threads : {1, 2, 3, 7}) {
    decltype(compute()) x;
    tbb::task_arena(threads).execute([&] { x = compute(); });
    if (first.empty()) first = x;
    EXPECT_EQ(x, first) << threads << " threads";
  }
}

}  // namespace gradus::test
