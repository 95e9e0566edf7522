// The link map φ from a frame to the next: one-to-one, and not everywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/field.h"

namespace gradus::reconstruct {

class WindowSource;

class CorrespondenceMap {
 public:
  // Where a pixel goes, relative to itself. Equal for neighbours that stay neighbours.
  using Shift = int32_t;
  static constexpr Shift kNone = INT32_MIN;

  CorrespondenceMap(int width, int height)
      : width_(width), height_(height), shifts_(size_t(width) * size_t(height), kNone) {}
  int width() const { return width_; }
  int height() const { return height_; }
  const Shift* row(int y) const { return shifts_.data() + size_t(y) * size_t(width_); }

  // From target pixels (WindowSource::read_correspondence()). Throws invalid_argument where a target lies outside or is
  // another pixel's, too: threads write to linked pixels.
  void set_row(int y, const int32_t* targets, std::vector<bool>* taken);

  // function(begin, end, dx, dy): pixels [begin, end) of row y go to the same place relative to themselves.
  template <class Function>
  void for_runs(int y, const Function& function) const {
    const Shift* shift = row(y);
    for (int begin = 0, end; begin < width_; begin = end) {
      const Shift here = shift[begin];
      for (end = begin + 1; end < width_ && shift[end] == here; ++end) {
      }
      if (here != kNone) function(begin, end, int(int16_t(here & 0xffff)), int(here >> 16));
    }
  }

 private:
  int width_, height_;
  std::vector<Shift> shifts_;  // dy and dx, 16 bits each
};

// From frame t of a window to the next.
CorrespondenceMap read_correspondence(const WindowSource& source, int t);

}  // namespace gradus::reconstruct
