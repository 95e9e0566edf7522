// The pictures of a sequence, one after the other: a window is solved when a picture is asked for that has a share in it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "reconstruct/space_time/reconstruct_sequence.h"
#include "reconstruct/space_time/regularized_windows.h"

namespace gradus {

// What makes pictures of a sequence differ.
struct SequenceMethod {
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2;  // L2, L1, WEIGHTED or REGULARIZED
  float alpha = 0.0f;                                  // 0: what measures best
  bool operator==(const SequenceMethod&) const = default;
};

// Where frames come from. Sizes and channels are the same for all.
struct SequenceInput {
  std::function<std::unique_ptr<HalvedWindowSource>(const FrameRange& frames)> open_window;
  RegularizedWindows::OpenFrame open_frame;  // for REGULARIZED
};

class SequencePictures {
 public:
  SequencePictures(const FrameRange& range, const WindowShape& shape, SequenceInput input, const SequenceMethod& method);

  const SequenceMethod& method() const { return method_; }
  // The frames that a picture depends on.
  FrameRange needs(int frame) const;
  // There are no frames beyond this one after all.
  void end_at(int frame) { grid_.end_at(frame); }
  // Channels interleaved; with its error, if the method is REGULARIZED. Each picture is taken once, in order, with gaps as the caller
  // likes; the first one may be any. Empty: cancelled, and no picture can be taken any more.
  Reconstructed take(int frame, const CancelTest& cancel, SolveReport* report);

 private:
  void solve_next(const CancelTest& cancel, SolveReport* report);

  WindowGrid grid_;
  WindowBlend blend_;
  SequenceInput input_;
  SequenceMethod method_;
  RegularizedWindows regularized_;
  size_t values_ = 0;  // of a picture; what comes behind them is its error
  std::optional<int> next_window_;
  std::map<int, std::vector<float>> ready_;
};

}  // namespace gradus
