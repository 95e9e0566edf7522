#include "reconstruct/space_time/window_grid.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/fault.h"
#include "base/types.h"

namespace gradus::reconstruct {

WindowGrid::WindowGrid(const FrameRange& range, const WindowShape& shape) : range_(range), shape_(shape) {
  if (range.last < range.first) throw invalid_argument("a range of frames ends before it begins");
  if (shape.frames < 1 || shape.overlap < 0 || shape.overlap > shape.frames / 2)
    throw invalid_argument("windows overlap by half of their frames at most");
  first_ = window_that_begins_before(range.first);
  // A last window is left out if the window before it contains all of its frames.
  last_ = std::max(first_, window_that_begins_before(int64_t{range.last} - shape.overlap));
}

int WindowGrid::window_that_begins_before(int64_t frame) const {
  const int64_t step = shape_.step();
  return int(frame >= 0 ? frame / step : -((step - 1 - frame) / step));
}

FrameRange WindowGrid::frames(int window) const {
  const int64_t begin = int64_t{window} * shape_.step(), last = begin + shape_.frames - 1;
  return {int(std::max<int64_t>(begin, range_.first)), int(std::min<int64_t>(last, range_.last))};
}

int WindowGrid::first_with(int frame) const {
  return std::max(first_, window_that_begins_before(int64_t{frame} - shape_.overlap));
}
int WindowGrid::last_with(int frame) const { return std::min(last_, window_that_begins_before(frame)); }

FrameRange WindowGrid::joined(int frame) const {
  const FrameRange shared = around(frame);
  return {std::max(shared.first, frame - shape_.reach()), std::min(shared.last, frame + shape_.reach())};
}

float WindowGrid::share(int window, int frame) const {
  const int64_t place = frame - int64_t{window} * shape_.step();
  if (place < 0 || place >= shape_.frames) return 0.0f;
  const bool begins = place < shape_.overlap && window > first_, ends = place >= shape_.step() && window < last_;
  if (!begins && !ends) return 1.0f;
  const int64_t along = begins ? place : place - shape_.step();
  const float s = std::sin(0.5f * kPi * (float(along) + 0.5f) / float(shape_.overlap));
  return begins ? s * s : 1.0f - (GRADUS_FAULT(window_shares_do_not_sum_to_1) ? s : s * s);
}

}  // namespace gradus::reconstruct
