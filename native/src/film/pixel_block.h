// Pixel blocks of 16×16 pixels, aligned to the full frame. The pixels of a block share sub-pixel jitter, and adaptive
// sampling estimates noise per block.
#pragma once

#include <cstdint>

namespace gradus::film {

inline constexpr int32_t kPixelBlockSide = 16;

// Returns the index of the block that contains coordinate x: x / side, rounded towards minus infinity.
inline int32_t pixel_block_of(int32_t x, int32_t side = kPixelBlockSide) {
  return x >= 0 ? x / side : -((-x + side - 1) / side);
}

}  // namespace gradus::film
