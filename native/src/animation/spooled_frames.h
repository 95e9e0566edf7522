// Windows of a sequence whose rows lie in temporary files. A frame that two windows share is loaded once.
#pragma once

#include <map>
#include <memory>

#include "animation/spooled_frame.h"
#include "animation/temporal_frame.h"
#include "base/cancel_check.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::animation {

class SpooledFrames {
 public:
  SpooledFrames(LoadSamples fresh, LoadSamples replay, TemporalContent content);
  ~SpooledFrames();

  // Returns the window of the frames from place `first` to `last`. Windows must be requested in order, since earlier
  // frames are forgotten. New frames are loaded one after the other with the threads of the caller's arena. Frames
  // without gradients have only rows of pixels and of their temporal differences; reading others throws
  // invalid_operation. `cancel` is polled here and for every row that is read from the window. It throws Error
  // CANCELLED; no further window can be requested then.
  std::unique_ptr<reconstruct::HalvedWindowSource> window(
      int first, int last, const CancelCheck& cancel = [] { return false; });

 private:
  class SpooledFresh;

  std::shared_ptr<const TemporalFrame> load(int place, const CancelCheck& cancel) const;
  // Returns the fresh samples of a frame that has been spooled: the differences to the next frame need them.
  std::shared_ptr<const TemporalFrame> fresh_of(int place, const CancelCheck& cancel) const;

  const LoadSamples fresh_, replay_;
  const TemporalContent content_;
  std::map<int, std::shared_ptr<SpooledFrame>> frames_;
  std::unique_ptr<const SpooledFresh> end_;  // last frame of the previous window
};

}  // namespace gradus::animation
