// Develops a frame of a sequence: its picture comes from the frames that are reconstructed with it, its passes from all
// of its samples, fresh and replayed.
#pragma once

#include <optional>

#include <tbb/task_arena.h>

#include "animation/sequence.h"
#include "base/cancel_check.h"
#include "output/developer.h"

namespace gradus::animation {

class FrameDeveloper {
 public:
  // requested: options that replace those with which the frame was sampled, and the number of threads; without a value
  // the settings that the folder holds are used. The sequence and `is_cancelled` must outlive the developer.
  FrameDeveloper(Sequence* sequence, int32_t number, const std::optional<GradusSettings>& requested,
                 const CancelCheck& is_cancelled);

  // Loads the samples of the frame. Throws Error CANCELLED, and invalid_argument for files that do not fit.
  std::shared_ptr<DevelopedFrame> load();
  // Reconstructs, denoises and splits the picture of a frame that load() returned. Throws Error CANCELLED.
  void develop_picture(DevelopedFrame* developed);

  // Whether `developed` is the same frame, developed with the same options.
  bool would_develop(const DevelopedFrame& developed) const;

 private:
  std::shared_ptr<DevelopedFrame> read();
  void check_cancelled() const;
  // Returns the options for which the frame is developed, AUTO included. `own` are the settings of its film.
  output::Options requested_options(const GradusSettings& own) const;
  // Returns the reconstruction of the frame, with its error and its components if they are requested. Components are
  // reconstructed by windows of their own, except by REGULARIZED.
  reconstruct::Reconstructed take_from_windows(const output::DevelopedFilm& developed, bool by_components,
                                               reconstruct::SolveReport* report);
  // Computes the passes Gradient T and Gradient T Correspondence from the fresh samples of the frame.
  void read_differences_over_time(const film::Film& fresh, output::DevelopedFilm* developed);

  Sequence& sequence_;
  const int32_t number_;
  const std::optional<GradusSettings> requested_;
  const CancelCheck& is_cancelled_;
  const uint32_t threads_;
  tbb::task_arena arena_;
  std::shared_ptr<const output::OidnLibrary> denoiser_;  // nullptr until load(), or if there is none
};

}  // namespace gradus::animation
