// Previews while a render takes its samples: first an image at a quarter of the size, then reconstructions of the film,
// so rarely that they take little time. Previews do not change the film, and are made only if a viewer reads Combined.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include <tbb/task_arena.h>

#include "output/developer.h"
#include "render/loop_input.h"
#include "render/picture.h"
#include "render/plan.h"
#include "render/progress_tracker.h"
#include "render/refresh_rule.h"

namespace gradus::render {

class Preview {
 public:
  // All arguments must outlive the object.
  Preview(const LoopInput& input, const Plan& plan, const std::atomic<bool>& stop, tbb::task_arena* arena,
          Picture* picture, ProgressTracker* tracker);

  // Notes that a viewer reads Combined. Thread-safe.
  void watch() { watched_.store(true, std::memory_order_relaxed); }

  // Return whether the quarter preview or the next refresh (see RefreshRule) is due, if `reconstruction` will run in
  // the end. Thread-safe.
  bool quarter_is_due(uint32_t reconstruction) const;
  bool refresh_is_due(uint32_t reconstruction, double sampled, double fraction) const;

  // Makes and shows the quarter preview. Called while no samples are taken.
  void show_quarter();
  // Reconstructs the film and shows the result. All pixels have samples in both half-buffers. `sampled` is the time of
  // sampling so far, in seconds.
  void refresh(const std::shared_ptr<const film::Film>& film, double sampled);

  double seconds() const { return seconds_; }
  double cpu_seconds() const { return cpu_seconds_; }

 private:
  bool is_watched() const { return watched_.load(std::memory_order_relaxed); }
  // Returns the reconstruction that previews use if `reconstruction` will run in the end. NONE: the noisy tiles are
  // shown.
  uint32_t shown(uint32_t reconstruction) const;
  bool is_stopped() const { return stop_.load(std::memory_order_relaxed); }
  // Samples the film of the quarter preview: plain paths, an eighth of a sample for each pixel of the full size.
  std::shared_ptr<const film::Film> sample_quarter() const;
  // Reconstructs a film. Returns nothing if the render was cancelled.
  std::optional<output::DevelopedFilm> develop(std::shared_ptr<const film::Film> film, uint32_t reconstruction,
                                               const Region& region,
                                               const reconstruct::ReconstructionOutputs& wanted) const;
  // Enlarges the images of the quarter preview to the delivered region.
  output::DevelopedFilm enlarge_quarter(const output::DevelopedFilm& quarter) const;

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
