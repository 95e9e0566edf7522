// The settings of the Image Texture and Environment Texture nodes, which are packed into the mode of their operations.
#pragma once

#include <algorithm>

#include "image/image_store.h"

namespace gradus::shading {

inline image::Interpolation interpolation_of(uint32_t mode) {
  return static_cast<image::Interpolation>(std::min(mode >> 2 & 3, 2u));
}

inline image::Extension extension_of(uint32_t mode) { return static_cast<image::Extension>(mode >> 4 & 3); }

}  // namespace gradus::shading
