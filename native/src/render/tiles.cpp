#include "render/tiles.h"

#include "film/pixel_blocks.h"

namespace gradus::render {

int tile_side(const Region& region, unsigned threads) {
  constexpr int64_t kTilesPerThread = 16;
  const int64_t large = region.area() / (4 * int64_t{film::kPixelBlockSide} * film::kPixelBlockSide);
  return large >= kTilesPerThread * int64_t(threads) ? 2 * film::kPixelBlockSide : film::kPixelBlockSide;
}

}  // namespace gradus::render
