// Parts of what read_images() and read_half_differences() give, and variances.
#pragma once

#include "frame/frame.h"

namespace gradus {

// Without differences in space.
GradientImages read_pixels(const Frame& frame, int component);
GradientImages read_half_differences_of_pixels(const Frame& frame, int component);
// Writes a row of what read_variance() gives, ((A - B)/2)² per channel (contract 1.2). y is counted from the
// region's first row. 0 where a half has no samples: one half alone says nothing.
void read_variance_row(const Frame& frame, int y, float* row);

}  // namespace gradus
