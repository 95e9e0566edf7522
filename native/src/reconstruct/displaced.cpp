#include "reconstruct/displaced.h"

#include <algorithm>

#include "base/rows.h"

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

Field displaced(const Field& image, const Field& displacements) {
  const int width = image.width();
  Field result(width, image.height(), image.channels());
  for_pieces(image.height(), [&](int begin, int end) {
    RowsAround around(width);
    for (int y = begin; y < end; ++y) {
      const auto by = [&](int x) {
        return Displacement{displacements.row(y, 0)[x], displacements.row(y, 1)[x], displacements.row(y, 2)[x],
                            displacements.row(y, 3)[x], displacements.row(y, 4)[x]};
      };
      for (int c = 0; c < image.channels(); ++c) {
        around.read(image, y, c);
        const float* from = image.row(y, c);
        float* to = result.row(y, c);
        for (int x = 0; x < width; ++x) to[x] = from[x] + around.change(x, by(x));
      }
    }
  });
  return result;
}

}  // namespace gradus::reconstruct
