#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Returns the values of an image at a displacement from the centre of each pixel, by cubic convolution (Keys 1981):
// linear interpolation would blur. `displacement`: x and y in pixels. Positions beyond the border are clamped to it.
Field displaced(const Field& image, const Field& displacement);

}  // namespace gradus::reconstruct
