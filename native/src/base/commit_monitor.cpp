#include "base/commit_monitor.h"

#include <algorithm>
#include <atomic>

#include "base/error.h"

namespace gradus {

void CommitMonitor::check() const {
  if (!is_running()) throw cancelled();
}

void CommitMonitor::report(float fraction) const {
  if (!progress_) return;
  std::atomic_ref<float> shared(*progress_);
  // Embree reports from several threads, in any order; the shared value only ever rises.
  float before = shared.load();
  while (before < fraction && !shared.compare_exchange_weak(before, fraction)) continue;
}

BuildProgress CommitMonitor::step(float first, float last) const {
  return [this, first, last](float fraction) {
    report(first + (last - first) * std::clamp(fraction, 0.0f, 1.0f));
    return is_running();
  };
}

}  // namespace gradus
