// Loops over all pixels of a film, with rows distributed over threads.
#pragma once

#include "base/rows.h"

namespace gradus::motion {

// Loops over one row. It must not be inlined: a compiler that made two variants of the loop would round differently in
// each, and which one a row gets would depend on the threads.
template <class Body>
[[gnu::noinline]] void pixels_of_row(int width, int y, const Body& body) {
  size_t p = size_t(y) * size_t(width);
  for (int x = 0; x < width; ++x, ++p) body(x, y, p);
}

// Calls body(x, y, p) for every pixel, where p = y·width + x is its index in planes.
template <class Body>
void each_pixel(int width, int height, const Body& body) {
  for_rows(height, [&](int y) { pixels_of_row(width, y, body); });
}

}  // namespace gradus::motion
