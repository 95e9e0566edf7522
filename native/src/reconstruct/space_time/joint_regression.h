// REGULARIZED over several frames: the windows of a picture's regression also hold the samples of the frames around it,
// at the places to which motion leads, with their fractions of a pixel. Samples of a frame whose light differs from that
// of the picture do not count there.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "film/replay_map.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/regression/feature_regression.h"
#include "reconstruct/solve_report.h"
#include "reconstruct/space_time/pixel_track.h"
#include "reconstruct/space_time/window_grid.h"

namespace gradus::reconstruct {

class JointRegression {
 public:
  // Return a frame's samples, with features, and the correspondence of its pixels to those of the frame before. Each is
  // called once for each frame. Both throw the error CANCELLED.
  using OpenFilm = std::function<std::shared_ptr<const film::Film>(int frame, const CancelCheck& cancel)>;
  using OpenCorrespondence = std::function<film::PixelCorrespondence(int frame, const CancelCheck& cancel)>;
  JointRegression(OpenFilm open, OpenCorrespondence correspondence)
      : open_(std::move(open)), correspondence_(std::move(correspondence)) {}

  // Reconstructs a frame from the frames `around` it. Frames must come in ascending order.
  Reconstructed reconstruct(int frame, const FrameRange& around, const CancelCheck& cancel, SolveReport* report);

 private:
  // What the regression reads of a frame, in the units of the film.
  struct Frame {
    film::Features features;
    HalvedImage image;
    Field deviation, own;
    film::PixelCorrespondence to_previous;
  };
  const Frame& frame(int number, const CancelCheck& cancel);
  MovedFrame moved(const Frame& frame, const PixelTrack& track, const Frame& here, const Field& still, float scale);

  OpenFilm open_;
  OpenCorrespondence correspondence_;
  std::map<int, Frame> frames_;
};

}  // namespace gradus::reconstruct
