// Images at lower resolutions, for look-ups that average many texels.
//
// Each resolution has a quarter of the rows and columns of the one before. The usual half would take a third of the
// memory of the full resolution; this takes a fifteenth, or two if the values are encoded, and a look-up still meets at
// most four texels of the chosen resolution along the part of the image that it covers.
//
// Look-ups interpolate encoded values and then decode them, as in Cycles. A texel at a lower resolution is the mean of
// the light of all look-ups in its area, which is less than that of the texels: a fine pattern of black and white gives
// 0.31 and not 0.5. It is stored as light.
#pragma once

#include "image/image.h"

namespace gradus::image {

// Returns whether some tile is large enough for a lower resolution: from 64 texels on the shorter side on.
bool can_be_coarser(const Image& image);

// Returns a copy that shares the pixels and has the coarser tiles of each tile, and of those again, down to 16 to 63
// texels on the shorter side. In colours that are divided by alpha, transparent texels count less.
std::shared_ptr<const Image> with_coarser_tiles(const Image& image);

}  // namespace gradus::image
