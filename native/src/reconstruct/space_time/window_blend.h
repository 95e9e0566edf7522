// Pictures of windows become one sequence, with no more kept than what the next window overlaps.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "reconstruct/reconstructed.h"
#include "reconstruct/space_time/window_grid.h"

namespace gradus::reconstruct {

class WindowBlend {
 public:
  // Takes a frame's picture when all windows have added to it; frames come in order.
  using Take = std::function<void(int frame, Reconstructed picture)>;
  WindowBlend(const WindowGrid& grid, Take take) : grid_(grid), take_(std::move(take)) {}

  // Windows in order, and their frames in order. An error of two that are blended is taken as that of their blend: it
  // is no larger.
  void add(int window, int frame, Reconstructed picture);

  // Whether a window has added to the frame, and others will.
  bool has_begun(int frame) const { return begun_.count(frame) > 0; }

 private:
  WindowGrid grid_;
  Take take_;
  std::map<int, Reconstructed> begun_;  // sums, by frame
};

}  // namespace gradus::reconstruct
