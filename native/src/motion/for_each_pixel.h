// All pixels of a film, row by row over the threads.
#pragma once

#include "base/rows.h"

namespace gradus::motion {

// A row is no part of what calls it: a compiler that makes two variants of it rounds differently in each, and which one
// a row gets would depend on the threads.
template <class Body>
[[gnu::noinline]] void pixels_of_row(int width, int y, const Body& body) {
  size_t p = size_t(y) * size_t(width);
  for (int x = 0; x < width; ++x, ++p) body(x, y, p);
}

// body(x, y, p), p the pixel's place in planes.
template <class Body>
void each_pixel(int width, int height, const Body& body) {
  for_rows(height, [&](int y) { pixels_of_row(width, y, body); });
}

}  // namespace gradus::motion
