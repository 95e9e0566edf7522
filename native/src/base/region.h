// Rectangles of film pixels, and the value of a pixel.
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/types.h"

namespace gradus {

// An integer rectangle of film pixels; x1 and y1 are exclusive.
struct Region {
  int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int32_t width() const { return x1 - x0; }
  int32_t height() const { return y1 - y0; }
  int64_t area() const { return int64_t(width()) * height(); }
  bool contains(int32_t x, int32_t y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  // Returns the index of a pixel in row-major order.
  size_t index(int32_t x, int32_t y) const { return size_t(y - y0) * size_t(width()) + size_t(x - x0); }
  bool operator==(const Region&) const = default;
};

// Scene-linear RGB radiance. The fourth channel is alpha if the film is transparent, else 0.
using Radiance = Vec4;

}  // namespace gradus
