// What a watcher sees while a render takes its samples: first a picture at a quarter of the size, then reconstructions
// of the frame, so seldom that they cost little. Nothing of it touches the frame; without a watcher nothing is done.
#pragma once

#include <atomic>

#include <tbb/task_arena.h>

#include "render/loop_input.h"
#include "render/picture.h"
#include "render/plan.h"
#include "render/progress_tracker.h"
#include "render/refresh_rule.h"

namespace gradus::render {

class Preview {
 public:
  // What it is given lives as long as it.
  Preview(const LoopInput& input, const Plan& plan, const std::atomic<bool>& stop, tbb::task_arena* arena,
          Picture* picture, ProgressTracker* tracker);

  // Somebody looks at Combined. From any thread.
  void watch() { watched_.store(true, std::memory_order_relaxed); }

  // Whether it is time, where `reconstruction` will run in the end. From any thread.
  bool quarter_is_due(uint32_t reconstruction) const;
  bool refresh_is_due(uint32_t reconstruction, double sampled, double fraction) const;  // see RefreshRule

  // Called while no samples are taken.
  void show_quarter();
  // frame: with samples of both halves in all pixels.
  void refresh(const film::Film& film, double sampled);

  double seconds() const { return seconds_; }
  double cpu_seconds() const { return cpu_seconds_; }

 private:
  bool is_watched() const { return watched_.load(std::memory_order_relaxed); }
  // What is shown where that will run; NONE: tiles are.
  uint32_t shown(uint32_t reconstruction) const;
  bool is_stopped() const { return stop_.load(std::memory_order_relaxed); }

  const LoopInput& input_;
  const Plan& plan_;
  const std::atomic<bool>& stop_;
  tbb::task_arena* const arena_;
  Picture* const picture_;
  ProgressTracker* const tracker_;
  std::atomic<bool> watched_{false};
  bool has_quarter_ = false;
  RefreshRule rule_;
  double seconds_ = 0.0, cpu_seconds_ = 0.0;
};

}  // namespace gradus::render
