// Conversions between RGB and the models HSV and HSL, with the hue in 0…1.
#pragma once

#include "base/types.h"

namespace gradus::shading {

Vec3 rgb_to_hsv(const Vec3& rgb);
Vec3 hsv_to_rgb(const Vec3& hsv);
Vec3 rgb_to_hsl(const Vec3& rgb);
Vec3 hsl_to_rgb(const Vec3& hsl);

}  // namespace gradus::shading
