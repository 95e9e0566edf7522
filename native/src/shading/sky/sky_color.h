// Conversion from CIE XYZ to the renderer's colours.
#pragma once

#include "base/types.h"

namespace gradus::shading {

// Converts to linear Rec. 709 with the white point D65. Colours outside the gamut have negative components.
inline Rgb xyz_to_rgb(const Vec3& c) {
  return Rgb(3.2404542f * c.x - 1.5371385f * c.y - 0.4985314f * c.z,
             -0.9692660f * c.x + 1.8760108f * c.y + 0.0415560f * c.z,
             0.0556434f * c.x - 0.2040259f * c.y + 1.0572252f * c.z);
}

}  // namespace gradus::shading
