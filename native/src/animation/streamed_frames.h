// Frames of a sequence one after the other, each with its differences to the next, read once.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "animation/load_samples.h"
#include "animation/temporal_frame.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class StreamedFrames {
 public:
  // All samples of a frame, made of its two parts.
  using Merge = std::function<std::shared_ptr<const film::Film>(int place, std::shared_ptr<film::Film> fresh,
                                                                const film::Film& replay)>;
  // Parts of frames with the same components.
  StreamedFrames(LoadSamples fresh, LoadSamples replay, Merge merge);

  // In order: a frame, then its differences. Other orders read more often. By the threads of the caller's arena. Throws
  // the Error CANCELLED.
  std::shared_ptr<const film::Film> frame(int place, const CancelCheck& cancel);
  // Of each component a window of the frame and the next one, with pixels and their differences over time alone.
  std::vector<std::unique_ptr<reconstruct::HalvedWindowSource>> differences(int place, const CancelCheck& cancel);

 private:
  using Images = std::vector<std::shared_ptr<const TemporalFrame>>;  // by component
  const Images& images(int place, const CancelCheck& cancel);
  void load(int place, const CancelCheck& cancel);

  const LoadSamples fresh_, replay_;
  const Merge merge_;
  std::map<int, Images> images_;                             // of two at most
  std::map<int, std::shared_ptr<const film::Film>> merged_;  // of the last one that was read, until it is asked for
};

}  // namespace gradus::animation
