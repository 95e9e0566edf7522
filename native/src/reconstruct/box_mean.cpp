#include "reconstruct/box_mean.h"

#include <algorithm>

#include "base/rows.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

// Writes the mean of the values within `radius` of each, as far as they lie in the row. Fields have zeros around the
// image.
void mean_along(const float* from, int length, int radius, float* to) {
  std::copy_n(from, length, to);
  for (int d = 1; d <= radius; ++d) {
    for (int x = 0; x < length; ++x) to[x] += from[x - d] + from[x + d];
  }
  for (int x = 0; x < length; ++x) to[x] /= static_cast<float>(count_within(x, radius, length));
}

}  // namespace

Field box_mean(const Field& image, int radius) {
  const int w = image.width(), h = image.height(), channels = image.channels();
  Field rows(w, h, channels), result(w, h, channels);
  for_rows(h, [&](int y) {
    for (int c = 0; c < channels; ++c) mean_along(image.row(y, c), w, radius, rows.row(y, c));
  });
  for_rows(h, [&](int y) {
    const int begin = std::max(0, y - radius), end = std::min(h, y + radius + 1);
    const float factor = 1.0f / static_cast<float>(end - begin);
    for (int c = 0; c < channels; ++c) {
      float* to = result.row(y, c);
      for (int i = begin; i < end; ++i) {
        const float* from = rows.row(i, c);
        for (int x = 0; x < w; ++x) to[x] += factor * from[x];
      }
    }
  });
  return result;
}

Field squared_light(const Field& image, int radius) {
  Field light = box_mean(
      make_field(image.width(), image.height(), [&](int x, int y) { return brightness_of(image, x, y); }), radius);
  for_values(&light, [](float& value, int, int, int) { value = (value + kDark) * (value + kDark); });
  return light;
}

}  // namespace gradus::reconstruct
