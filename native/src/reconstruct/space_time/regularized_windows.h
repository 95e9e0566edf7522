// REGULARIZED over time. The picture of each frame by itself is the data, and what linked pixels change by from frame
// to frame, by regression too, joins them along their tracks; each counts by its estimated error. What changes was
// sampled: it shows at once.
//
// Components go their own ways, each with its picture and its changes. All else they share: what they become where
// their ways agree is what becomes of their sum.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "film/features.h"
#include "film/film.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/space_time/regress_change.h"
#include "reconstruct/space_time/window_grid.h"

namespace gradus::reconstruct {

class RegularizedWindows {
 public:
  // All samples of a frame, replays too, with features: asked for once, and not kept. Both throw the Error CANCELLED.
  using OpenFilm = std::function<std::shared_ptr<const film::Film>(int frame, const CancelCheck& cancel)>;
  // Of each component a window of a frame and the next one, of which rows of pixels over time are read; after the frame
  // itself.
  using OpenDifferences = std::function<ComponentSources(int frame, const CancelCheck& cancel)>;
  RegularizedWindows(OpenFilm open, OpenDifferences differences)
      : open_(std::move(open)), differences_(std::move(differences)) {}

  // Takes the pictures of a window's frames, in order, t counted from its first. Windows come in order: what two of
  // them share is computed once. Nothing is taken when cancelled.
  using Take = std::function<void(int t, Reconstructed picture)>;
  void reconstruct(const FrameRange& frames, const CancelCheck& cancel, SolveReport* report, const Take& take);

 private:
  struct Estimate {
    std::vector<Field> pictures;   // of the components
    Field error;                   // of their sum
    Field weight;                  // 1/error
    size_t brightest = 0;          // of the components
    film::Features features;       // until the change is known
    std::optional<Change> change;  // to the next frame, where that is in the same window
  };
  // changes: the next frame is in the window, too.
  const Estimate& estimated(int frame, bool changes, const CancelCheck& cancel, SolveReport* report);
  static Estimate estimate_single_frame(const film::Film& samples, const CancelCheck& cancel, SolveReport* report);

  OpenFilm open_;
  OpenDifferences differences_;
  std::map<int, Estimate> estimates_;  // by frame
};

}  // namespace gradus::reconstruct
