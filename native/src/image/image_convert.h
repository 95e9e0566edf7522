// From decoded files to stored tiles: colour space, alpha, broken numbers.
#pragma once

#include <string>

#include "image/image.h"

namespace gradus::image {

class ColorManager;

// 8 bit data and sRGB stay 8 bit; 16 bit data stay 16 bit; other integers become half, floats stay what they are.
// Straight alpha that is not associated yet becomes so if `associate`.
ImageTile convert_tile(DecodedImage decoded, const ColorManager& color, const std::string& space, bool associate);

// Mean colour over at most about a million texels.
Rgb mean_color(const ImageTile& tile);
// Whether the alpha of any texel is below 1: all are looked at, for a material may be taken for opaque by it.
bool has_transparency(const ImageTile& tile);

}  // namespace gradus::image
