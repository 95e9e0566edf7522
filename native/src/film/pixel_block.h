// The lattice of cells of 16×16 pixels, fixed to the full frame, on which sub-pixel jitter is shared and noise is
// judged (contract 1.6, 5.3).
#pragma once

#include <cstdint>

namespace gradus::film {

inline constexpr int32_t kPixelBlockSide = 16;

// Cell of `side` that holds a coordinate; below 0, too, towards minus infinity.
inline int32_t pixel_block_of(int32_t x, int32_t side = kPixelBlockSide) {
  return x >= 0 ? x / side : -((-x + side - 1) / side);
}

}  // namespace gradus::film
