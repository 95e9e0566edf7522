// Pixel correspondences between a frame and the next one.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace gradus::film {

// Marks a pixel without a correspondence.
inline constexpr int32_t kNoCorrespondence = -1;

// Maps pixels of one frame to pixels of the other; empty if no pixel has a correspondence.
struct PixelCorrespondence {
  std::vector<int32_t> pixel;  // pixel index in the other frame, or kNoCorrespondence
  // End of the film displacement from the earlier frame, relative to the centre of the pixel in the later frame, in
  // [-0.5, 0.5] pixels per axis. Indexed like `pixel`; empty if all displacements end at pixel centres.
  std::vector<Vec2> off_centre{};

  bool empty() const { return pixel.empty(); }
  bool operator==(const PixelCorrespondence&) const = default;
};

}  // namespace gradus::film
