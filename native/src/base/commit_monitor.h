// Progress and cancellation of Scene::commit().
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace gradus {

// Callback of a build: receives the finished fraction of a step, in [0, 1], and returns false to stop the build.
using BuildProgress = std::function<bool(float)>;

// Reports the progress of a commit to the caller and reads the caller's cancel flag. It is thread-safe, because Embree
// calls it from several threads. Both pointers may be null.
class CommitMonitor {
 public:
  CommitMonitor(const volatile int32_t* cancel, float* progress) : cancel_(cancel), progress_(progress) {}
  bool is_running() const { return !cancel_ || *cancel_ == 0; }
  // Throws Error CANCELLED if the caller has set the cancel flag.
  void check() const;
  // Calls check() at each 65,536th index of a loop.
  void check_at(size_t index) const {
    if (index % 65536 == 0) check();
  }
  // Returns the callback of a step that covers the fractions from `first` to `last` of the whole commit.
  BuildProgress step(float first, float last) const;
  // Raises the progress of the whole commit to `fraction`, in [0, 1]; a smaller value than before has no effect.
  void report(float fraction) const;

 private:
  const volatile int32_t* cancel_;
  float* progress_;
};

}  // namespace gradus
