// Pixels of a frame's region, row by row over the threads.
#pragma once

#include "base/rows.h"
#include "film/film.h"

namespace gradus::film {

// function(i, out): the pixel's place in the frame's planes, and in those of the region.
template <class Function>
void for_pixels(const Film& film, const Region& region, const Function& function) {
  for_rows(region.height(), [&](int row) {
    size_t i = film.index(region.x0, region.y0 + row), out = size_t(row) * size_t(region.width());
    for (int32_t x = region.x0; x < region.x1; ++x) function(i++, out++);
  });
}

}  // namespace gradus::film
