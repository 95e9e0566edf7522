#include "reconstruct/space_time/sequence_pictures.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "reconstruct/space_time/reconstruct_window.h"

namespace gradus::reconstruct {

SequencePictures::SequencePictures(const FrameRange& range, const WindowShape& shape, SequenceSource source,
                                   const SequenceMethod& method)
    : grid_(range, shape),
      source_(std::move(source)),
      method_(method),
      regularized_(source_.frame, source_.differences),
      joint_(source_.frame, source_.correspondence),
      blend_(grid_, [this](int frame, Reconstructed picture) { ready_[frame] = std::move(picture); }) {}

bool SequencePictures::has(int frame) const {
  if (!grid_.contains(frame)) return false;
  return !next_window_ || ready_.count(frame) > 0 || *next_window_ <= grid_.first_with(frame) ||
         (*next_window_ <= grid_.last_with(frame) && blend_.has_begun(frame));
}

Reconstructed SequencePictures::take(int frame, const CancelCheck& cancel, SolveReport* report) {
  if (!has(frame)) throw invalid_operation("frame " + std::to_string(frame) + " was delivered before");
  if (const char* k = std::getenv("JOINT"); k && method_.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
    const FrameRange around = grid_.around(frame);
    const int reach = std::atoi(k);
    return joint_.reconstruct(frame, {std::max(around.first, frame - reach), std::min(around.last, frame + reach)}, cancel, report);
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
  if (method_.reconstruction == GRADUS_RECONSTRUCTION_REGULARIZED) {
    regularized_.reconstruct(frames, cancel, report, take);
  } else {
    reconstruct_window(*source_.window(frames, cancel), method_.reconstruction, method_.alpha, method_.with_error,
                       cancel, report, take);
  }
}

}  // namespace gradus::reconstruct
