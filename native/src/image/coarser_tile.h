// Images at lower resolutions, for look-ups that average many texels.
//
// Each resolution has a quarter of the rows and columns of the one before. The usual half would take a third of the
// memory of the full resolution; this takes a fifteenth, and a look-up still meets at most four texels of the chosen
// resolution along the part of the image that it covers.
#pragma once

#include "image/image.h"

namespace gradus::image {

// Sets `coarser` of a tile, and of that again, down to 16 to 63 texels on the shorter side. A texel is the mean of
// those that it covers, as light: encoded values are decoded first, and if colours are multiplied by alpha
// (`is_associated`), transparent texels count less.
void add_coarser_tiles(ImageTile* tile, bool is_associated);

}  // namespace gradus::image
