// Reads images without spatial differences, and variances.
#pragma once

#include "film/film.h"

namespace gradus::film {

// read_images() and read_half_differences() without dx and dy.
GradientImages read_pixels(const Film& film, int component);
GradientImages read_half_differences_of_pixels(const Film& film, int component);
// Writes the estimated variances of the means in a row, ((A - B)/2)² per channel, where A and B are the sums of all
// components. y counts from the region's first row. The variance is 0 where a half-buffer has no samples, because one
// alone gives no estimate.
void read_variance_row(const Film& film, int y, float* row);

}  // namespace gradus::film
