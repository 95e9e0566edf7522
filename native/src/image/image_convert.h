// Conversion of decoded files to stored tiles: colour space, alpha, and removal of infinities and NaN.
#pragma once

#include <string>

#include "image/image.h"

namespace gradus::image {

class ColorManager;

// Converts a decoded image. Data without a conversion and sRGB keep their number of bits, other integers become half,
// and floats stay floats. If the image is not a float image, sRGB values stay encoded: Cycles multiplies them by alpha,
// interpolates them and divides them by alpha before it decodes them. If `associate`, colours are multiplied by alpha,
// but for grey images, which Cycles leaves as they are.
ImageTile convert_tile(DecodedImage decoded, const ColorManager& color, const std::string& space, bool is_float,
                       bool associate);

// Returns the scene-linear mean colour of at most about a million texels.
Rgb mean_color(const ImageTile& tile);
// Returns whether any texel has an alpha below 1. It tests all texels, because materials become opaque on its account.
bool has_transparency(const ImageTile& tile);

}  // namespace gradus::image
