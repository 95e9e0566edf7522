#include "reconstruct/space_time/sequence_pictures.h"

#include "base/error.h"

namespace gradus {

SequencePictures::SequencePictures(const FrameRange& range, const WindowShape& shape, OpenWindow open, const SequenceMethod& method)
    : grid_(range, shape),
      blend_(grid_, [this](int frame, std::vector<float> image) { ready_[frame] = std::move(image); }),
      open_(std::move(open)),
      method_(method) {}

FrameRange SequencePictures::needs(int frame) const {
  return {grid_.frames(grid_.first_with(frame)).first, grid_.frames(grid_.last_with(frame)).last};
}

std::vector<float> SequencePictures::take(int frame, const CancelTest& cancel, SolveReport* report) {
  if (!next_window_) next_window_ = grid_.first_with(frame);
  while (ready_.count(frame) == 0) {
    if (*next_window_ > grid_.last_with(frame))
      throw invalid_operation("the picture of frame " + std::to_string(frame) + " was taken before");
    solve_next(cancel, report);
    if (cancel()) return {};
  }
  std::vector<float> image = std::move(ready_[frame]);
  ready_.erase(ready_.begin(), ready_.upper_bound(frame));
  return image;
}

void SequencePictures::solve_next(const CancelTest& cancel, SolveReport* report) {
  const int window = (*next_window_)++;
  const FrameRange frames = grid_.frames(window);
  const std::unique_ptr<WindowSource> source = open_(frames);
  reconstruct_window(*source, method_.reconstruction, method_.alpha, cancel, report,
                     [&](int t, std::vector<float> image) { blend_.add(window, frames.first + t, std::move(image)); });
}

}  // namespace gradus
