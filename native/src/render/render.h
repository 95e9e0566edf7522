// The loop (contract 1.8): plan, batches, frame, reconstruction, error, next batch. It alone loops; it owns cancel, progress, clock.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "frame/frame.h"
#include "gradus/gradus.h"
#include "scene/snapshot.h"

namespace gradus {

class Device;

class Render {
 public:
  // Starts on a thread of its own. Throws invalid_argument for settings that cannot be obeyed (contract 5.1).
  Render(std::shared_ptr<Device> device, std::shared_ptr<const Snapshot> snapshot, const GradusSettings& settings);
  ~Render();  // cancels and waits
  Render(const Render&) = delete;
  Render& operator=(const Render&) = delete;

  GradusProgress progress() const;
  void cancel();
  // False: still running after `seconds`. Rethrows nothing; see failure().
  bool wait(double seconds);
  GradusError outcome(std::string* text) const;  // OK, CANCELLED or the failure, once ended
  void read_pass(uint32_t pass, float* pixels, size_t count) const;
  std::string stats_json() const;
  std::shared_ptr<const Frame> frame() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gradus
