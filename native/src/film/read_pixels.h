// Parts of what read_images() and read_half_differences() give, and variances.
#pragma once

#include "film/film.h"

namespace gradus::film {

// Without differences in space.
GradientImages read_pixels(const Film& film, int component);
GradientImages read_half_differences_of_pixels(const Film& film, int component);
// Writes the estimated variances of the means in a row of the primal, ((A - B)/2)² per channel (contract 1.2). y is
// counted from the region's first row. 0 where a half has no samples: one half alone says nothing.
void read_variance_row(const Film& film, int y, float* row);

}  // namespace gradus::film
