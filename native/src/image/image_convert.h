// Conversion of decoded files to stored tiles: colour space, alpha, and removal of infinities and NaN.
#pragma once

#include <string>

#include "image/image.h"

namespace gradus::image {

class ColorManager;

// How the colours of a decoded image relate to its alpha.
enum class AlphaRelation {
  None,        // they stay as they are
  Straight,    // they are still to be multiplied by it
  Associated,  // they are multiplied by it
};

// Converts a decoded image. Data without a conversion and sRGB keep their number of bits, other integers become half,
// and floats stay floats. If the image is not a float image, sRGB values stay encoded: Cycles multiplies them by alpha,
// interpolates them and divides them by alpha before it decodes them. Straight colours are multiplied by alpha, but for
// those of grey images, which Cycles leaves as they are. A conversion other than sRGB sees colours that are not
// multiplied by alpha.
ImageTile convert_tile(DecodedImage decoded, const ColorManager& color, const std::string& space, bool is_float,
                       AlphaRelation relation);

// Returns the scene-linear mean colour of at most about a million texels.
Rgb mean_color(const ImageTile& tile);
// Returns whether any texel has an alpha below 1. It tests all texels, because materials become opaque on its account.
bool has_transparency(const ImageTile& tile);

}  // namespace gradus::image
