// Work tiles: cells of full-frame coordinates (film/pixel_blocks.h).
#pragma once

#include "film/pixel_blocks.h"

namespace gradus::render {

// 32 where there are enough tiles to keep the threads busy, else 16. A multiple of kPixelBlockSide.
int tile_side(const Region& region, unsigned threads);

}  // namespace gradus::render
