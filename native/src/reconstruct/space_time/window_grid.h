// Windows on a fixed grid of frame numbers, [5k, 5k + 9], and how their pictures become one (contract 4.1).
#pragma once

namespace gradus {

inline constexpr int kWindowFrames = 10;
inline constexpr int kWindowStep = 5;

// First and last.
struct FrameRange {
  int first = 0, last = 0;
  int count() const { return last - first + 1; }
  bool contains(int frame) const { return frame >= first && frame <= last; }
};

// The windows of a range of frames: its ends shrink them, and one that another then contains is left out.
class WindowGrid {
 public:
  explicit WindowGrid(const FrameRange& range);
  int first() const { return first_; }
  int last() const { return last_; }
  FrameRange frames(int window) const;
  // Share of a window in a frame's picture: a Hann window, of which two that overlap by half add up to 1. 1 where there is no other.
  float share(int window, int frame) const;

 private:
  FrameRange range_;
  int first_, last_;
};

}  // namespace gradus
