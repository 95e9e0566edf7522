#include "reconstruct/space_time/sequence_pictures.h"

#include "base/error.h"

namespace gradus {

SequencePictures::SequencePictures(const FrameRange& range, const WindowShape& shape, SequenceInput input, const SequenceMethod& method)
    : grid_(range, shape),
      blend_(grid_, [this](int frame, std::vector<float> image) { ready_[frame] = std::move(image); }),
      input_(std::move(input)),
      method_(method),
      regularized_(input_.open_frame) {}

FrameRange SequencePictures::needs(int frame) const {
  return {grid_.frames(grid_.first_with(frame)).first, grid_.frames(grid_.last_with(frame)).last};
}

Reconstructed SequencePictures::take(int frame, const CancelTest& cancel, SolveReport* report) {
  if (!next_window_) next_window_ = grid_.first_with(frame);
  while (ready_.count(frame) == 0) {
    if (*next_window_ > grid_.last_with(frame))
      throw invalid_operation("the picture of frame " + std::to_string(frame) + " was taken before");
    solve_next(cancel, report);
    if (cancel()) return {};
  }
  Reconstructed picture{std::move(ready_[frame]), {}};
  ready_.erase(ready_.begin(), ready_.upper_bound(frame));
  picture.error.assign(picture.image.begin() + ptrdiff_t(values_), picture.image.end());
  picture.image.resize(values_);
  return picture;
}

void SequencePictures::solve_next(const CancelTest& cancel, SolveReport* report) {
  const int window = (*next_window_)++;
  const FrameRange frames = grid_.frames(window);
  const std::unique_ptr<HalvedWindowSource> source = input_.open_window(frames);
  const WindowSize size = source->size();
  values_ = size_t(size.width) * size_t(size.height) * size_t(size.channels);
  const auto add = [&](int t, std::vector<float> image) { blend_.add(window, frames.first + t, std::move(image)); };
  if (method_.reconstruction != GRADUS_RECONSTRUCTION_REGULARIZED) {
    reconstruct_window(*source, method_.reconstruction, method_.alpha, cancel, report, add);
    return;
  }
  regularized_.reconstruct(frames, *source, cancel, report, [&](int t, Reconstructed picture) {
    picture.image.insert(picture.image.end(), picture.error.begin(), picture.error.end());
    add(t, std::move(picture.image));
  });
}

}  // namespace gradus
