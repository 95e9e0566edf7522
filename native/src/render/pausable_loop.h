// A parallel loop that can pause so that other work runs in between.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace gradus::render {

// Calls body(i) for each i that is not done, on all threads of the caller's arena, until a call returns true, which
// requests a pause. The body sets done[i], or leaves it 0 so that it is called again later. Returns whether all are
// done.
template <class Body>
bool run_until_pause(std::vector<uint8_t>* done, Body&& body) {
  std::atomic<bool> pause{false};
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, done->size(), 1),
      [&](const tbb::blocked_range<size_t>& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
          if ((*done)[i] != 0 || pause.load(std::memory_order_relaxed)) continue;
          if (body(i)) pause.store(true, std::memory_order_relaxed);
        }
      },
      tbb::simple_partitioner());
  return std::all_of(done->begin(), done->end(), [](uint8_t is_done) { return is_done != 0; });
}

}  // namespace gradus::render
