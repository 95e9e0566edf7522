// Pictures of windows become one sequence, with no more kept than what the next window overlaps.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "reconstruct/space_time/window_grid.h"

namespace gradus {

class WindowBlend {
 public:
  // Takes a frame's picture when all windows have added to it; frames come in order.
  using Take = std::function<void(int frame, std::vector<float> image)>;
  WindowBlend(const WindowGrid& grid, Take take) : grid_(grid), take_(std::move(take)) {}

  // Windows in order, and their frames in order.
  void add(int window, int frame, std::vector<float> image);

 private:
  WindowGrid grid_;
  Take take_;
  std::map<int, std::vector<float>> begun_;  // sums, by frame
};

}  // namespace gradus
