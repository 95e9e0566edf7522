// Progress and cancellation of Scene::commit().
#pragma once

#include <cstdint>
#include <functional>

namespace gradus {

// Receives the fraction of a step that is done; returns false to stop it.
using BuildProgress = std::function<bool(float)>;

// Reports the progress of a commit to the caller and asks whether to go on. Embree calls it from several threads.
class CommitMonitor {
 public:
  CommitMonitor(const volatile int32_t* cancel, float* progress) : cancel_(cancel), progress_(progress) {}
  bool is_running() const { return !cancel_ || *cancel_ == 0; }
  void check() const;  // throws Error CANCELLED
  // fraction of the step that runs from `first` to `last`.
  BuildProgress step(float first, float last) const;
  void report(float fraction) const;

 private:
  const volatile int32_t* cancel_;
  float* progress_;
};

}  // namespace gradus
