// The pixel correspondence φ from one frame to the next. It is one-to-one and not defined for all pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "reconstruct/field.h"

namespace gradus::reconstruct {

class WindowSource;

class CorrespondenceMap {
 public:
  // Displacement of a pixel to its correspondence. Neighbours that remain neighbours have equal shifts.
  using Shift = int32_t;
  static constexpr Shift kNone = INT32_MIN;

  CorrespondenceMap(int width, int height)
      : width_(width), height_(height), shifts_(size_t(width) * size_t(height), kNone) {}
  int width() const { return width_; }
  int height() const { return height_; }
  const Shift* row(int y) const { return shifts_.data() + size_t(y) * size_t(width_); }

  // Sets row y from target pixels (WindowSource::read_correspondence()). `taken` has a bit for each pixel, set for
  // those that are a target already. Throws `invalid_argument` if a target lies outside the image or is already taken:
  // threads write to target pixels without a lock.
  void set_row(int y, const int32_t* targets, std::vector<bool>* taken);

  // Calls function(begin, end, dx, dy) for each run of pixels [begin, end) of row y with the same displacement.
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
  std::vector<Shift> shifts_;  // dy in the upper and dx in the lower 16 bits
};

// Reads the pixel correspondence from frame t of a window to frame t + 1.
CorrespondenceMap read_correspondence(const WindowSource& source, int t);

}  // namespace gradus::reconstruct
