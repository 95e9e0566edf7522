#include "reconstruct/space_time/window_grid.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/types.h"

namespace gradus {
namespace {

int window_that_begins_before(int frame) { return frame >= 0 ? frame / kWindowStep : -((kWindowStep - 1 - frame) / kWindowStep); }

}  // namespace

WindowGrid::WindowGrid(const FrameRange& range)
    : range_(range), first_(window_that_begins_before(range.first)), last_(std::max(first_, window_that_begins_before(range.last) - 1)) {
  if (range.last < range.first) throw invalid_argument("a range of frames ends before it begins");
}

FrameRange WindowGrid::frames(int window) const {
  const int begin = window * kWindowStep;
  return {std::max(begin, range_.first), std::min(begin + kWindowFrames - 1, range_.last)};
}

float WindowGrid::share(int window, int frame) const {
  if (!frames(window).contains(frame)) return 0.0f;
  const int place = frame - window * kWindowStep, other = place < kWindowStep ? window - 1 : window + 1;
  if (other < first_ || other > last_) return 1.0f;
  const float s = std::sin(kPi * (float(place) + 0.5f) / kWindowFrames);
  return s * s;
}

}  // namespace gradus
