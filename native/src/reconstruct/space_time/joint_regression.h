// REGULARIZED over several frames. The samples of the frames around a picture are joined with its own, pixel by pixel
// (joined_samples.h), at the places to which motion leads, with their fractions of a pixel. Samples whose light is not
// that of the picture do not count (light_test.h). Every picture is a linear function of the samples of its frame and
// of the others, so that components and alpha go through the same operator.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/cancel_check.h"
#include "film/film.h"
#include "film/replay_map.h"
#include "reconstruct/field_memory.h"
#include "reconstruct/reconstructed.h"
#include "reconstruct/solve_report.h"
#include "reconstruct/space_time/joined_samples.h"
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
  Reconstructed reconstruct(int frame, const FrameRange& around, const CancelCheck& cancel, SolveReport* report,
                            const JoinedOutputs& wanted = {});

 private:
  struct Frame {
    int32_t stream = 0;
    film::PixelCorrespondence to_previous;        // empty if the frame is a repeated one
    std::shared_ptr<const FrameRecords> records;  // frames that are repeated share them
  };
  // Reads a frame unless that was done.
  void read(int number, const CancelCheck& cancel);
  // Returns whether a frame is known to have the samples of the one before.
  bool is_repeated(int number) const;
  // Returns the frames `numbers`, moved to frame `number`, whose own image is `image`.
  std::vector<JoinedFrame> move_frames(int number, const HalvedImage& image, const std::vector<int>& numbers,
                                       const CancelCheck& cancel) const;

  std::optional<KeptFieldMemory> memory_;  // from the first picture on, for the next ones
  OpenFilm open_film_;
  OpenStep open_step_;
  std::map<int, Frame> frames_;
};

}  // namespace gradus::reconstruct
