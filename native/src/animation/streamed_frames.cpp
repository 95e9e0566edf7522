#include "animation/streamed_frames.h"

#include <utility>

#include "animation/frame_window.h"
#include "base/error.h"

namespace gradus::animation {

StreamedFrames::StreamedFrames(LoadSamples fresh, LoadSamples replay, Merge merge)
    : fresh_(std::move(fresh)), replay_(std::move(replay)), merge_(std::move(merge)) {}

std::shared_ptr<const film::Film> StreamedFrames::merged_film(int place, const CancelCheck& cancel) {
  if (merged_.count(place) == 0) load(place, cancel);
  return std::move(merged_.extract(place).mapped());
}

std::vector<std::unique_ptr<reconstruct::HalvedWindowSource>> StreamedFrames::differences(int place,
                                                                                          const CancelCheck& cancel) {
  const Images frame = images(place, cancel), next = images(place + 1, cancel);
  images_ = {{place + 1, next}};
  if (frame.size() != next.size()) throw invalid_argument("two frames of a sequence have different components");
  std::vector<std::unique_ptr<reconstruct::HalvedWindowSource>> windows;
  for (size_t k = 0; k < frame.size(); ++k) {
    windows.push_back(
        std::make_unique<FrameWindow>(std::vector<std::shared_ptr<const TemporalFrame>>{frame[k], next[k]}));
  }
  return windows;
}

const StreamedFrames::Images& StreamedFrames::images(int place, const CancelCheck& cancel) {
  if (images_.count(place) == 0) load(place, cancel);
  return images_.at(place);
}

void StreamedFrames::load(int place, const CancelCheck& cancel) {
  merged_.clear();
  const std::shared_ptr<film::Film> fresh = fresh_(place, cancel);
  const std::shared_ptr<const film::Film> replay = replay_(place, cancel);
  while (images_.size() > 1) images_.erase(images_.begin());
  Images& images = images_[place];
  images.clear();
  for (int k = 0; k < int(fresh->components.size()); ++k) {
    images.push_back(std::make_shared<TemporalFrame>(make_temporal_frame(*fresh, *replay, {.gradients = false}, k)));
  }
  merged_[place] = merge_(place, fresh, *replay);
}

}  // namespace gradus::animation
