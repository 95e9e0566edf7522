// Windows of a sequence, whose rows lie in temporary files. What two windows share is read once.
#pragma once

#include <map>
#include <memory>

#include "animation/load_samples.h"
#include "animation/spooled_frame.h"
#include "base/cancel_check.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class SpooledFrames {
 public:
  SpooledFrames(LoadSamples fresh, LoadSamples replay, TemporalContent content);
  ~SpooledFrames();

  // The frames from `first` to `last`. Windows come in order: frames before this one's are forgotten. Reads what is
  // new, one frame after the other, by the threads of the caller's arena. Of frames without gradients there are rows of
  // pixels and of their differences over time alone: to read others throws invalid_operation. `cancel` is asked all the
  // while, and for every row that is read of the window: throws the Error CANCELLED, after which no window can be had.
  std::unique_ptr<reconstruct::HalvedWindowSource> window(
      int first, int last, const CancelCheck& cancel = [] { return false; });

 private:
  class SpooledFresh;

  std::shared_ptr<const TemporalFrame> load(int place, const CancelCheck& cancel) const;
  // What the differences to the next frame need of one that is there.
  std::shared_ptr<const TemporalFrame> fresh_of(int place, const CancelCheck& cancel) const;

  const LoadSamples fresh_, replay_;
  const TemporalContent content_;
  std::map<int, std::shared_ptr<SpooledFrame>> frames_;
  std::unique_ptr<const SpooledFresh> end_;  // of the window before: its last frame
};

}  // namespace gradus::animation
