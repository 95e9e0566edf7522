// REGULARIZED over several frames. The data are the images that each frame gives by itself, and the regressed changes
// of corresponding pixels from frame to frame, which join the images along the tracks of pixels. Both are weighted by
// their estimated errors. The changes come from samples, so that the picture follows a change without delay.
//
// Components may have different correspondences, and each has its own images and changes. They share all weights, so
// that where their correspondences agree they add up to the reconstruction of their sum.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/cancel_check.h"
#include "film/features.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solve_report.h"
#include "reconstruct/space_time/regress_change.h"
#include "reconstruct/space_time/window_grid.h"

namespace gradus::reconstruct {

class RegularizedWindows {
 public:
  // Returns all samples of a frame, fresh and replayed, with features. Called once for each frame; the film is not
  // kept. Both callbacks throw the error CANCELLED.
  using OpenFilm = std::function<std::shared_ptr<const film::Film>(int frame, const CancelCheck& cancel)>;
  // Returns, for each component, a window of a frame and the next one, of which the temporal rows of pixels are read.
  // Called after OpenFilm for the same frame.
  using OpenDifferences = std::function<ComponentSources(int frame, const CancelCheck& cancel)>;
  RegularizedWindows(OpenFilm open, OpenDifferences differences)
      : open_(std::move(open)), differences_(std::move(differences)) {}

  // Reconstructs the frames of a window and passes their images to take(), in order, with t counted from the window's
  // first frame. Windows must come in order; what two of them share is computed once. When cancelled, take() is not
  // called.
  using Take = std::function<void(int t, Reconstructed picture)>;
  void reconstruct(const FrameRange& frames, const CancelCheck& cancel, SolveReport* report, const Take& take);

 private:
  struct Estimate {
    std::vector<Field> pictures;   // images of the components
    Field error;                   // squared error of their sum
    Field weight;                  // 1/error
    size_t brightest = 0;          // index of the brightest component
    film::Features features;       // kept until the change is known
    std::optional<Change> change;  // change to the next frame, if that is in the same window
  };
  // Returns the estimate of a frame, made at the first call. `changes`: whether the next frame is in the window, too.
  const Estimate& estimated(int frame, bool changes, const CancelCheck& cancel, SolveReport* report);
  static Estimate estimate_single_frame(const film::Film& samples, const CancelCheck& cancel, SolveReport* report);

  OpenFilm open_;
  OpenDifferences differences_;
  std::map<int, Estimate> estimates_;  // key: frame number
};

}  // namespace gradus::reconstruct
