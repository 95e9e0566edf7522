// What runs on a thread of its own, and what can be asked of it meanwhile from others: progress, cancel, outcome.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "base/clock.h"
#include "base/error.h"
#include "film/film.h"
#include "gradus/gradus.h"
#include "render/progress_tracker.h"

namespace gradus::render {

class RenderTask {
 public:
  RenderTask() : process_cpu_start_(process_cpu_nanoseconds()) {}
  virtual ~RenderTask() = default;
  RenderTask(const RenderTask&) = delete;
  RenderTask& operator=(const RenderTask&) = delete;

  // Does the work; called once, on the task's thread. Never throws: what goes wrong becomes the outcome.
  void run() noexcept;

  virtual void cancel() { stop_.store(true, std::memory_order_relaxed); }
  // False: still running after `seconds` (negative: no limit).
  bool wait(double seconds) const;
  virtual GradusProgress progress() const;
  // OK, CANCELLED or the failure. Throws invalid_operation while running; so do stats() and frame().
  GradusError outcome(std::string* text) const;

  // What read_pass() gives.
  virtual const Region& delivered() const = 0;
  virtual void read_pass(uint32_t pass, float* pixels) const = 0;
  // Of a component.
  virtual void read_component(const std::string& name, uint32_t pass, float* pixels) const = 0;
  virtual std::string stats() const = 0;
  virtual std::shared_ptr<const film::Film> film() const = 0;

 protected:
  virtual void render() = 0;
  // Called with the lock, when nothing more is done.
  virtual void ending(GradusError) {}
  // Called with the lock.
  virtual uint64_t memory_bytes() const = 0;

  bool is_stopped() const { return stop_.load(std::memory_order_relaxed); }
  // Throws the Error CANCELLED.
  void check_cancelled() const {
    if (is_stopped()) throw cancelled();
  }
  bool is_ended() const { return phase_ >= GRADUS_PHASE_DONE; }
  // Throws invalid_operation while running. With the lock.
  void require_end(const char* what) const;
  // The same, and where the task has ended without a frame: `failure`, and why. With the lock.
  void require_film(const std::shared_ptr<const film::Film>& film, const char* what, const char* failure) const;
  double seconds() const { return clock_.seconds(); }
  double process_cpu_seconds() const { return 1e-9 * double(process_cpu_nanoseconds() - process_cpu_start_); }

  std::atomic<bool> stop_{false};
  ProgressTracker tracker_;
  mutable std::mutex mutex_;  // guards what follows, and what its heirs say
  GradusPhase phase_ = GRADUS_PHASE_WAITING;
  std::string text_;

 private:
  void end(GradusError code, const std::string& text) noexcept;

  const WallClock clock_;
  const uint64_t process_cpu_start_;
  mutable std::condition_variable ended_;
  GradusError code_ = GRADUS_OK;
  double total_seconds_ = 0.0;
};

}  // namespace gradus::render
