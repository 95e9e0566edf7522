// Pixels of the film, and what they hold.
#pragma once

#include <cstdint>

#include "base/types.h"

namespace gradus {

// Integer rectangle of film pixels, upper bounds exclusive.
struct Region {
  int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int32_t width() const { return x1 - x0; }
  int32_t height() const { return y1 - y0; }
  int64_t area() const { return int64_t(width()) * height(); }
  bool contains(int32_t x, int32_t y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  bool operator==(const Region&) const = default;
};

// Radiance (RGB) and, with a transparent film, alpha as the fourth channel; 0 otherwise.
using Radiance = Vec4;

}  // namespace gradus
