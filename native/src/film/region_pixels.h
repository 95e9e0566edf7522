// Iterates over the pixels of a region of a film, with rows distributed over the threads.
#pragma once

#include "base/rows.h"
#include "film/film.h"

namespace gradus::film {

// Calls function(i, out) per pixel, where i is its index in the film's planes and out its index within `region`.
template <class Function>
void for_pixels(const Film& film, const Region& region, const Function& function) {
  for_rows(region.height(), [&](int row) {
    size_t i = film.index(region.x0, region.y0 + row), out = size_t(row) * size_t(region.width());
    for (int32_t x = region.x0; x < region.x1; ++x) function(i++, out++);
  });
}

}  // namespace gradus::film
