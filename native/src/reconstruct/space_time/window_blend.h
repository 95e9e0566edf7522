// Blends the images of overlapping windows to one sequence. Keeps only the frames that the next window overlaps.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "reconstruct/reconstructed.h"
#include "reconstruct/space_time/window_grid.h"

namespace gradus::reconstruct {

class WindowBlend {
 public:
  // Receives a frame's image once all windows have contributed to it. Frames come in order.
  using Take = std::function<void(int frame, Reconstructed picture)>;
  WindowBlend(const WindowGrid& grid, Take take) : grid_(grid), take_(std::move(take)) {}

  // Adds the image of a frame by one window. Windows come in order, and so do their frames. Errors are blended as
  // images are: the result is an upper bound of the error of the blend.
  void add(int window, int frame, Reconstructed picture);

 private:
  WindowGrid grid_;
  Take take_;
  std::map<int, Reconstructed> begun_;  // weighted sums; key: frame number
};

}  // namespace gradus::reconstruct
