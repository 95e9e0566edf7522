// The pictures of a sequence, one after the other: a window is solved when a picture is asked for that has a share in
// it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "reconstruct/reconstructed.h"
#include "reconstruct/space_time/regularized_windows.h"
#include "reconstruct/space_time/window_blend.h"

namespace gradus::reconstruct {

// What makes pictures of a sequence differ.
struct SequenceMethod {
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2;  // L2, L1 or REGULARIZED
  float alpha = 0.0f;                                  // 0: what measures best
  bool with_error = false;                             // whether the pictures' errors, or their terms, are wanted
  bool operator==(const SequenceMethod&) const = default;
};

// Where a sequence comes from. Its frames are of one size.
struct SequenceSource {
  // The frames of a window, for all but REGULARIZED. Windows come in order. Throws the Error CANCELLED.
  std::function<std::unique_ptr<HalvedWindowSource>(const FrameRange& frames, const CancelCheck& cancel)> window;
  // For REGULARIZED.
  RegularizedWindows::OpenFilm frame;
  RegularizedWindows::OpenDifferences differences;
};

class SequencePictures {
 public:
  SequencePictures(const FrameRange& range, const WindowShape& shape, SequenceSource source,
                   const SequenceMethod& method);

  const SequenceMethod& method() const { return method_; }
  // There are no frames beyond this one after all.
  void end_at(int frame) { grid_.end_at(frame); }
  // The frames that have a share in the picture of one of them.
  FrameRange around(int frame) const { return grid_.around(frame); }
  // Whether the picture can be taken: it was not yet, nor a later one.
  bool has(int frame) const;
  // Channels interleaved. Each picture is taken once, in order, with gaps as the caller likes; the first one may be
  // any. Empty, or the Error CANCELLED where a frame was being read: cancelled, and no picture can be taken any more.
  Reconstructed take(int frame, const CancelCheck& cancel, SolveReport* report);

 private:
  void solve_next(const CancelCheck& cancel, SolveReport* report);

  WindowGrid grid_;
  SequenceSource source_;
  SequenceMethod method_;
  RegularizedWindows regularized_;
  WindowBlend blend_;
  std::optional<int> next_window_;
  std::map<int, Reconstructed> ready_;
};

}  // namespace gradus::reconstruct
