// The images of a sequence, one after another. A window is solved when an image is requested that it contributes to.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "reconstruct/reconstructed.h"
#include "reconstruct/space_time/joint_regression.h"
#include "reconstruct/space_time/window_blend.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

// Options of a sequence's reconstruction.
struct SequenceMethod {
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2;  // L2, L1 or REGULARIZED
  float alpha = 0.0f;                                  // 0 selects the default (chosen_alpha())
  bool with_error = false;                             // whether to estimate errors, or their terms
  bool operator==(const SequenceMethod&) const = default;
};

// Input of a sequence. All frames have the same size.
struct SequenceSource {
  // Opens the frames of a window, for all reconstructions except REGULARIZED. Windows come in order. Throws the error
  // CANCELLED.
  std::function<std::unique_ptr<HalvedWindowSource>(const FrameRange& frames, const CancelCheck& cancel)> window;
  // Callbacks for REGULARIZED.
  JointRegression::OpenFilm frame;
  JointRegression::OpenStep step;
};

class SequencePictures {
 public:
  SequencePictures(const FrameRange& range, const WindowShape& shape, SequenceSource source,
                   const SequenceMethod& method);

  const SequenceMethod& method() const { return method_; }
  // Ends the sequence after `frame`.
  void end_at(int frame) { grid_.end_at(frame); }
  // Returns the frames that contribute to the image of `frame`.
  FrameRange around(int frame) const;
  // Returns whether take(frame) is possible: no image was taken, or that of the frame before was the last one.
  bool has(int frame) const;
  // Returns the image of a frame, with interleaved channels. Images are taken one after another, from any frame on.
  // When cancelled, returns an empty image, or throws the error CANCELLED if a frame was being read; after that no
  // image can be taken. `wanted` counts for REGULARIZED alone.
  Reconstructed take(int frame, const CancelCheck& cancel, SolveReport* report, const JoinedOutputs& wanted = {});

 private:
  bool is_joint() const { return method_.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED; }
  void solve_next(const CancelCheck& cancel, SolveReport* report);

  WindowGrid grid_;
  SequenceSource source_;
  SequenceMethod method_;
  JointRegression joint_;
  std::optional<int> last_;  // last frame whose image was taken
  WindowBlend blend_;
  std::optional<int> next_window_;
  std::map<int, Reconstructed> ready_;
};

}  // namespace gradus::reconstruct
