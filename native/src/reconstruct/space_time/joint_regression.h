// REGULARIZED over several frames. The windows of a picture's regression also hold the samples of the frames around it,
// at the places to which motion leads, with their fractions of a pixel. Samples whose light is not that of the picture
// do not count (light_test.h). Every picture is a linear function of the samples of its frame and of the others, so
// that components and alpha go through the same operator.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "film/replay_map.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solve_report.h"
#include "reconstruct/space_time/pixel_track.h"
#include "reconstruct/space_time/window_grid.h"

namespace gradus::reconstruct {

// How a frame follows the one before.
struct FrameStep {
  int32_t stream = 0;  // frame that was sampled: an earlier one if nothing has changed since
  film::PixelCorrespondence to_previous;
};

class JointRegression {
 public:
  // Return all samples of a frame, with features, and how it follows the frame before. Both throw the error CANCELLED.
  using OpenFilm = std::function<std::shared_ptr<const film::Film>(int frame, const CancelCheck& cancel)>;
  using OpenStep = std::function<FrameStep(int frame, const CancelCheck& cancel)>;
  JointRegression(OpenFilm film, OpenStep step) : open_film_(std::move(film)), open_step_(std::move(step)) {}

  // Reconstructs a frame from itself and the others of the range `around` it. Frames must come in ascending order; what
  // two of them share is read once. When cancelled, returns an empty image or throws the error CANCELLED.
  Reconstructed reconstruct(int frame, const FrameRange& around, const CancelCheck& cancel, SolveReport* report);

 private:
  // What the pictures of other frames read of a frame, in the units of its film.
  struct Frame {
    FrameStep step;
    Field features;  // normal, albedo, depth
    float typical_depth = 1.0f;
    HalvedImage image;
    PixelWeights weights;
    std::vector<Field> sampled;  // by component; empty if the picture has neither alpha nor several components
  };
  // A picture that other frames contribute to, in units of its median luminance.
  struct Picture {
    float scale = 1.0f, unit = 1.0f;  // median luminance, typical depth
    HalvedImage image;
    Field weights;  // of its pixels in windows
    Field depths;
    Field alone;  // the picture by its own samples, in large windows
  };
  const Frame& frame(int number, const CancelCheck& cancel);
  // Returns where the pixels of another frame lie in a frame.
  PixelTrack track(int other, int frame) const;
  static Picture make_picture(const Frame& here, const CancelCheck& cancel);
  // Returns the features of a frame's own regression.
  static Field features_of(const Frame& frame);
  // Adds a frame to those that contribute to a picture. Returns the shares of the pixels' weights that are kept.
  static Field move_frame(const Frame& frame, const PixelTrack& track, const Picture& picture, OtherFrames* others);
  // Returns the frames `numbers`, moved to frame `number`.
  OtherFrames join(int number, const std::vector<int>& numbers, const CancelCheck& cancel) const;

  OpenFilm open_film_;
  OpenStep open_step_;
  std::map<int, Frame> frames_;
};

}  // namespace gradus::reconstruct
