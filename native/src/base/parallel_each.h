// A loop whose iterations run in parallel.
#pragma once

#include <cstddef>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/commit_monitor.h"

namespace gradus {

// Calls visit(i) for each i below `count`, `kGrain` by a task. A thousand suit iterations that take well below 1 µs.
template <size_t kGrain = 1024, class Visit>
void parallel_each(size_t count, const Visit& visit) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, kGrain), [&](const auto& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) visit(i);
  });
}

// As above. Throws Error CANCELLED if the caller of the commit cancels it.
template <size_t kGrain = 1024, class Visit>
void parallel_each(size_t count, const CommitMonitor& monitor, const Visit& visit) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, kGrain), [&](const auto& range) {
    if (!monitor.is_running()) return;
    for (size_t i = range.begin(); i < range.end(); ++i) visit(i);
  });
  monitor.check();
}

}  // namespace gradus
