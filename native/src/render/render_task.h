// A task that runs on its own thread, with progress, cancellation and outcome for other threads.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "base/clock.h"
#include "base/error.h"
#include "base/fault.h"
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

  // Does the work. Called once, on the thread of the task. Never throws: an error becomes the outcome.
  void run() noexcept;

  virtual void cancel() { stop_.store(!GRADUS_FAULT(cancel_missed_by_render), std::memory_order_relaxed); }
  // Waits until the task has ended. Returns false if it is still running after `seconds` (negative: no limit).
  bool wait(double seconds) const;
  virtual GradusProgress progress() const;
  // Returns OK, CANCELLED or the error. outcome(), stats() and film() throw `invalid_operation` while running.
  GradusError outcome(std::string* text) const;

  // Returns the region that read_pass(), read_component() and read_channel() copy.
  virtual const Region& delivered() const = 0;
  virtual void read_pass(uint32_t pass, float* pixels) const = 0;
  // Copies a pass of a component; see Render::read_component().
  virtual void read_component(const std::string& name, uint32_t pass, float* pixels) const = 0;
  // Copies a layer of a channel; see Render::read_channel().
  virtual void read_channel(uint32_t kind, const std::string& name, uint32_t layer, float* pixels) const = 0;
  virtual std::string stats() const = 0;
  virtual std::shared_ptr<const film::Film> film() const = 0;

 protected:
  virtual void render() = 0;
  // Called with mutex_ locked, after render() has ended.
  virtual void ending(GradusError) {}
  // Returns the present memory of the task in bytes. Called with mutex_ locked.
  virtual uint64_t memory_bytes() const = 0;

  bool is_stopped() const { return stop_.load(std::memory_order_relaxed); }
  // Throws the Error CANCELLED if the task was cancelled.
  void check_cancelled() const {
    if (is_stopped()) throw cancelled();
  }
  bool is_ended() const { return phase_ >= GRADUS_PHASE_DONE; }
  // Throws `invalid_operation` while running; `what` names the result that was requested. Called with mutex_ locked.
  void require_end(const char* what) const;
  // Like require_end(), and throws `invalid_operation` with `failure` and the cause if the task has ended without a
  // film. Called with mutex_ locked.
  void require_film(const std::shared_ptr<const film::Film>& film, const char* what, const char* failure) const;
  double seconds() const { return clock_.seconds(); }
  double process_cpu_seconds() const { return 1e-9 * double(process_cpu_nanoseconds() - process_cpu_start_); }

  std::atomic<bool> stop_{false};
  ProgressTracker tracker_;
  mutable std::mutex mutex_;  // guards phase_, text_ and the members that derived classes name
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
