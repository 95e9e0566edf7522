// The pictures of a sequence, one after the other: a window is solved when a picture is asked for that has a share in it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "reconstruct/space_time/reconstruct_sequence.h"

namespace gradus {

// What makes pictures of a sequence differ.
struct SequenceMethod {
  uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2;  // L2, L1 or WEIGHTED
  float alpha = 0.0f;                                  // 0: what measures best
  bool operator==(const SequenceMethod&) const = default;
};

class SequencePictures {
 public:
  SequencePictures(const FrameRange& range, const WindowShape& shape, OpenWindow open, const SequenceMethod& method);

  const SequenceMethod& method() const { return method_; }
  // The frames that a picture depends on.
  FrameRange needs(int frame) const;
  // There are no frames beyond this one after all.
  void end_at(int frame) { grid_.end_at(frame); }
  // Channels interleaved. Each picture is taken once, in order, with gaps as the caller likes; the first one may be any. Empty: cancelled,
  // and no picture can be taken any more.
  std::vector<float> take(int frame, const CancelTest& cancel, SolveReport* report);

 private:
  void solve_next(const CancelTest& cancel, SolveReport* report);

  WindowGrid grid_;
  WindowBlend blend_;
  OpenWindow open_;
  SequenceMethod method_;
  std::optional<int> next_window_;
  std::map<int, std::vector<float>> ready_;
};

}  // namespace gradus
