// Interpolation of values on a plane of pixels, and loops over its pixels. Positions are in pixels, with 0 at the
// centre of the first pixel. Beyond the outermost pixel centres the plane continues with the values at its border.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "base/cubic_weights.h"
#include "base/rows.h"
#include "base/types.h"

namespace gradus::motion {

template <class T>
struct FilmPlane {
  int width = 0, height = 0;
  std::span<const T> values;  // row by row

  const T& at(int x, int y) const {
    return values[size_t(std::clamp(y, 0, height - 1)) * size_t(width) + size_t(std::clamp(x, 0, width - 1))];
  }
};

// Returns the nearest position that lies between pixel centres of the plane.
inline Vec2 clamped_to(const Vec2& p, int width, int height) {
  return glm::clamp(p, Vec2(0.0f), Vec2(float(width - 1), float(height - 1)));
}

// Clamps a vector to the width and height of the film. A vector that is not finite becomes 0.
inline Vec2 bounded(const Vec2& vector, int width, int height) {
  const Vec2 maximum = {float(width), float(height)};
  return is_finite(vector.x) && is_finite(vector.y) ? glm::clamp(vector, -maximum, maximum) : Vec2(0.0f);
}

// Interpolates bilinearly.
template <class T>
T linear_at(const FilmPlane<T>& plane, const Vec2& position) {
  const Vec2 p = clamped_to(position, plane.width, plane.height), first = glm::floor(p), u = p - first;
  const auto x = int(first.x), y = int(first.y);
  const T upper = (1.0f - u.x) * plane.at(x, y) + u.x * plane.at(x + 1, y);
  const T lower = (1.0f - u.x) * plane.at(x, y + 1) + u.x * plane.at(x + 1, y + 1);
  return (1.0f - u.y) * upper + u.y * lower;
}

// Interpolates bicubically (base/cubic_weights.h).
template <class T>
T cubic_at(const FilmPlane<T>& plane, const Vec2& position) {
  const Vec2 p = clamped_to(position, plane.width, plane.height), first = glm::floor(p);
  const auto across = cubic_weights(p.x - first.x), down = cubic_weights(p.y - first.y);
  T result(0.0f);
  for (int j = 0; j < 4; ++j) {
    T row(0.0f);
    for (int i = 0; i < 4; ++i) row += across[size_t(i)] * plane.at(int(first.x) + i - 1, int(first.y) + j - 1);
    result += down[size_t(j)] * row;
  }
  return result;
}

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
