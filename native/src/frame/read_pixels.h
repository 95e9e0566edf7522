// Parts of what read_images() and read_half_differences() give.
#pragma once

#include "frame/frame.h"

namespace gradus {

// Without differences in space.
GradientImages read_pixels(const Frame& frame, int component);
GradientImages read_half_differences_of_pixels(const Frame& frame, int component);

}  // namespace gradus
