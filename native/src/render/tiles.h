// Work tiles: pixel blocks in full-frame coordinates (film/pixel_blocks.h).
#pragma once

#include "film/pixel_blocks.h"

namespace gradus::render {

// Returns the side of the tiles in pixels: 32 if that gives enough tiles to keep all threads busy, else 16. It is a
// multiple of kPixelBlockSide.
int tile_side(const Region& region, unsigned threads);

}  // namespace gradus::render
