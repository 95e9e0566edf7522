// Links between the pixels of a frame and those of the next one.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace gradus::film {

// Linked to nothing.
inline constexpr int32_t kNoCorrespondence = -1;

// From the pixels of one of the two frames to those of the other; no pixels: none is linked.
struct PixelCorrespondence {
  std::vector<int32_t> pixel;  // kNoCorrespondence: none
  // Where the way from the earlier frame ends, from the middle of the pixel in the later one: within half a pixel, so
  // that a link is the way to a whole pixel. Likewise by `pixel`; empty: in the middle.
  std::vector<Vec2> off_centre{};

  bool empty() const { return pixel.empty(); }
  bool operator==(const PixelCorrespondence&) const = default;
};

}  // namespace gradus::film
