#include "temporal/streamed_frames.h"

#include <utility>
#include <vector>

#include "temporal/frame_window.h"

namespace gradus {

StreamedFrames::StreamedFrames(LoadPart base, LoadPart replay, Merge merge)
    : base_(std::move(base)), replay_(std::move(replay)), merge_(std::move(merge)) {}

std::shared_ptr<const Frame> StreamedFrames::frame(int place, const CancelTest& cancel) {
  if (merged_.count(place) == 0) load(place, cancel);
  return std::move(merged_.extract(place).mapped());
}

std::unique_ptr<HalvedWindowSource> StreamedFrames::differences(int place, const CancelTest& cancel) {
  const auto frame = images(place, cancel), next = images(place + 1, cancel);
  images_ = {{place + 1, next}};
  return std::make_unique<FrameWindow>(std::vector<std::shared_ptr<const TemporalFrame>>{frame, next});
}

std::shared_ptr<const TemporalFrame> StreamedFrames::images(int place, const CancelTest& cancel) {
  if (images_.count(place) == 0) load(place, cancel);
  return images_.at(place);
}

void StreamedFrames::load(int place, const CancelTest& cancel) {
  merged_.clear();
  const std::shared_ptr<Frame> base = base_(place, cancel);
  const std::shared_ptr<const Frame> replay = replay_(place, cancel);
  while (images_.size() > 1) images_.erase(images_.begin());
  images_[place] = std::make_shared<TemporalFrame>(make_temporal_frame(*base, *replay, {.gradients = false}));
  merged_[place] = merge_(place, base, *replay);
}

}  // namespace gradus
