// Windows on a fixed grid of frame numbers, such as [5k, 5k + 9], which does not depend on the job, and the weights by
// which their images are blended.
#pragma once

#include <algorithm>
#include <cstdint>

namespace gradus::reconstruct {

// Number of frames of a window, and of those that it shares with the next one: at most half.
struct WindowShape {
  int frames = 10, overlap = 5;
  int step() const { return frames - overlap; }
  // Number of frames to each side of a picture whose samples REGULARIZED joins with its own.
  int reach() const { return (frames - 1) / 2; }
  bool operator==(const WindowShape&) const = default;
};

// The frames from `first` to `last`, both included.
struct FrameRange {
  int first = 0, last = 0;
  int count() const { return last - first + 1; }
  bool contains(int frame) const { return frame >= first && frame <= last; }
};

// The windows of a range of frames. Windows are shortened at the ends of the range; one that another then contains is
// left out.
class WindowGrid {
 public:
  // Throws `invalid_argument` if the range ends before it begins or windows share more than half of their frames.
  explicit WindowGrid(const FrameRange& range, const WindowShape& shape = {});
  const WindowShape& shape() const { return shape_; }
  int first() const { return first_; }
  int last() const { return last_; }
  FrameRange frames(int window) const;
  // Returns the first or last window that contains a frame of the range.
  int first_with(int frame) const;
  int last_with(int frame) const;
  // Returns all frames of the windows that contain `frame`.
  FrameRange around(int frame) const { return {frames(first_with(frame)).first, frames(last_with(frame)).last}; }
  // Returns the frames whose samples REGULARIZED joins with those of `frame`: those within reach, of those `around`.
  FrameRange joined(int frame) const;
  bool contains(int frame) const { return range_.contains(frame); }
  // Returns the share of a window in a frame's image: a Hann window over the frames that two windows share, where the
  // shares add up to 1; 1 where there is no other window.
  float share(int window, int frame) const;
  // Ends the range after `frame`: later windows end there. Shares are unchanged.
  void end_at(int frame) { range_.last = std::min(range_.last, frame); }

 private:
  int window_that_begins_before(int64_t frame) const;

  FrameRange range_;
  WindowShape shape_;
  int first_, last_;
};

}  // namespace gradus::reconstruct
