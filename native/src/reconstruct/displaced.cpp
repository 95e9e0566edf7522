#include "reconstruct/displaced.h"

#include <algorithm>

#include "base/rows.h"
#include "base/types.h"

namespace gradus::reconstruct {

RowsAround::RowsAround(int width) : width_(width), values_(3 * (size_t(width) + 2)) {}

void RowsAround::read(const Field& image, int y, int channel) {
  for (int j = -1; j <= 1; ++j) {
    const float* from = image.row(std::clamp(y + j, 0, image.height() - 1), channel);
    float* to = values_.data() + size_t(j + 1) * (size_t(width_) + 2);
    to[0] = from[0];
    std::copy_n(from, width_, to + 1);
    to[width_ + 1] = from[width_ - 1];
  }
}

float RowsAround::limited(int x, const Displacement& by) const {
  float smallest = row(0)[x], largest = smallest;
  for (int j = -1; j <= 1; ++j) {
    for (int i = x - 1; i <= x + 1; ++i) {
      smallest = std::min(smallest, row(j)[i]);
      largest = std::max(largest, row(j)[i]);
    }
  }
  return std::clamp(row(0)[x] + change(x, by), smallest, largest);
}

namespace {

// Calls use(around, x, y, channel, displacement) for every value of an image.
template <class Use>
void for_displaced(const Field& image, const Field& displacements, const Use& use) {
  for_pieces(image.height(), [&](int begin, int end) {
    RowsAround around(image.width());
    for (int y = begin; y < end; ++y) {
      for (int c = 0; c < image.channels(); ++c) {
        around.read(image, y, c);
        for (int x = 0; x < image.width(); ++x) {
          const auto by = [&](int channel) { return displacements.row(y, channel)[x]; };
          use(around, x, y, c, Displacement{by(0), by(1), by(2), by(3), by(4)});
        }
      }
    }
  });
}

}  // namespace

Field displaced(const Field& image, const Field& displacements) {
  Field result(image.width(), image.height(), image.channels());
  for_displaced(image, displacements, [&](const RowsAround& around, int x, int y, int c, const Displacement& by) {
    result.row(y, c)[x] = image.row(y, c)[x] + around.change(x, by);
  });
  return result;
}

void move_to_centres(const Field& picture, const Field& displacements, Field* means) {
  for_displaced(picture, displacements, [&](const RowsAround& around, int x, int y, int c, const Displacement& by) {
    float& mean = means->row(y, c)[x];
    const float moved = mean - (around.limited(x, by) - picture.row(y, c)[x]);
    if (is_finite(moved)) mean = mean >= 0.0f ? std::max(moved, 0.0f) : std::min(moved, 0.0f);
  });
}

}  // namespace gradus::reconstruct
