#include "reconstruct/space_time/sequence_pictures.h"

#include <string>

#include "base/error.h"
#include "reconstruct/space_time/reconstruct_window.h"

namespace gradus::reconstruct {

SequencePictures::SequencePictures(const FrameRange& range, const WindowShape& shape, SequenceSource source,
                                   const SequenceMethod& method)
    : grid_(range, shape),
      source_(std::move(source)),
      method_(method),
      joint_(source_.frame, source_.step),
      blend_(grid_, [this](int frame, Reconstructed picture) { ready_[frame] = std::move(picture); }) {}

FrameRange SequencePictures::around(int frame) const { return is_joint() ? grid_.joined(frame) : grid_.around(frame); }

bool SequencePictures::has(int frame) const { return grid_.contains(frame) && (!last_ || frame == *last_ + 1); }

Reconstructed SequencePictures::take(int frame, const CancelCheck& cancel, SolveReport* report,
                                     const JoinedOutputs& wanted) {
  if (!has(frame)) throw invalid_operation("frame " + std::to_string(frame) + " does not follow the last one");
  last_ = frame;
  if (is_joint()) {
    return joint_.reconstruct(frame, around(frame), cancel, report, wanted);
  }
  if (!next_window_) next_window_ = grid_.first_with(frame);
  while (ready_.count(frame) == 0) {
    solve_next(cancel, report);
    if (cancel()) return {};
  }
  Reconstructed picture = std::move(ready_[frame]);
  ready_.erase(ready_.begin(), ready_.upper_bound(frame));
  return picture;
}

void SequencePictures::solve_next(const CancelCheck& cancel, SolveReport* report) {
  const int window = (*next_window_)++;
  const FrameRange frames = grid_.frames(window);
  const auto take = [&](int t, Reconstructed picture) { blend_.add(window, frames.first + t, std::move(picture)); };
  reconstruct_window(*source_.window(frames, cancel), method_.reconstruction, method_.alpha, method_.with_error, cancel,
                     report, take);
}

}  // namespace gradus::reconstruct
