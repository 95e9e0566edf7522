// Windows on a fixed grid of frame numbers, such as [5k, 5k + 9], and how their pictures become one (contract 4.1).
#pragma once

#include <algorithm>
#include <cstdint>

namespace gradus::reconstruct {

// Frames of a window, and those that it shares with the next one: half of them at most.
struct WindowShape {
  int frames = 10, overlap = 5;
  int step() const { return frames - overlap; }
  bool operator==(const WindowShape&) const = default;
};

// First and last.
struct FrameRange {
  int first = 0, last = 0;
  int count() const { return last - first + 1; }
  bool contains(int frame) const { return frame >= first && frame <= last; }
};

// The windows of a range of frames: its ends shrink them, and one that another then contains is left out.
class WindowGrid {
 public:
  // Throws invalid_argument for a range that ends before it begins, and for windows that share more than half of their
  // frames.
  explicit WindowGrid(const FrameRange& range, const WindowShape& shape = {});
  int first() const { return first_; }
  int last() const { return last_; }
  FrameRange frames(int window) const;
  // The windows that hold a frame of the range.
  int first_with(int frame) const;
  int last_with(int frame) const;
  // The frames of these windows.
  FrameRange around(int frame) const { return {frames(first_with(frame)).first, frames(last_with(frame)).last}; }
  bool contains(int frame) const { return range_.contains(frame); }
  // Share of a window in a frame's picture: a Hann window over what two of them share, where they add up to 1. 1 where
  // there is no other.
  float share(int window, int frame) const;
  // There are no frames beyond this one after all: windows that are still to come end there. Shares stay as they were.
  void end_at(int frame) { range_.last = std::min(range_.last, frame); }

 private:
  int window_that_begins_before(int64_t frame) const;

  FrameRange range_;
  WindowShape shape_;
  int first_, last_;
};

}  // namespace gradus::reconstruct
