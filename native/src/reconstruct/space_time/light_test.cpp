#include "reconstruct/space_time/light_test.h"

#include <algorithm>
#include <cstdlib>

#include "reconstruct/box_mean.h"

namespace gradus::reconstruct {
namespace {

float envl(const char* name, float standard) {
  const char* text = std::getenv(name);
  return text ? float(std::atof(text)) : standard;
}

// Side in pixels of the cells that large squares consist of.
constexpr int kCell = 4;

// Sums for the test, of pixels or of cells: w e for three channels, and the sum of w² v over them.
Field weighted(const Field& difference, const Field& variance, const Field& weights) {
  Field sums(difference.width(), difference.height(), 4);
  for_values(&sums, [&](float& value, int x, int y, int c) {
    const float w = weights.row(y)[x];
    if (w == 0.0f) return;
    value = c < 3 ? w * difference.row(y, c)[x]
                  : w * w * (variance.row(y, 0)[x] + variance.row(y, 1)[x] + variance.row(y, 2)[x]);
  });
  return sums;
}

Field cells_of(const Field& image) {
  Field cells((image.width() + kCell - 1) / kCell, (image.height() + kCell - 1) / kCell, image.channels());
  for_values(&cells, [&](float& value, int x, int y, int c) {
    for (int j = y * kCell; j < std::min(image.height(), (y + 1) * kCell); ++j) {
      for (int i = x * kCell; i < std::min(image.width(), (x + 1) * kCell); ++i) value += image.row(j, c)[i];
    }
  });
  return cells;
}

// Multiplies `kept` by what the test in squares of this radius says.
void test(const Field& sums, int radius, Field* kept) {
  static const float lo = envl("LT_LO", 6), hi = envl("LT_HI", 12);
  const Field means = box_mean(sums, radius);
  for_values(kept, [&](float& value, int x, int y, int) {
    // box_mean() averages over the part of the square that lies in the image.
    const int w = sums.width(), h = sums.height();
    const float n = float((std::min(x + radius, w - 1) - std::max(x - radius, 0) + 1) *
                          (std::min(y + radius, h - 1) - std::max(y - radius, 0) + 1));
    float square = 0.0f;
    for (int c = 0; c < 3; ++c) square += means.row(y, c)[x] * means.row(y, c)[x];
    const float noise = means.row(y, 3)[x];
    const float z = noise > 0.0f ? n * square / noise : square > 0.0f ? hi : 0.0f;
    value *= std::clamp((hi - z) / (hi - lo), 0.0f, 1.0f);
  });
}

}  // namespace

Field same_light(const Field& difference, const Field& variance, const Field& weights) {
  const int w = weights.width(), h = weights.height();
  const Field sums = weighted(difference, variance, weights), cells = cells_of(sums);
  const auto ones = [](int width, int height) { return make_field(width, height, [](int, int) { return 1.0f; }); };
  Field kept = ones(w, h), of_cells = ones(cells.width(), cells.height());
  for (const int radius : {2, 4}) test(sums, radius, &kept);
  for (const int radius : {2, 4, 8}) test(cells, radius, &of_cells);
  for_values(&kept, [&](float& value, int x, int y, int) { value *= of_cells.row(y / kCell)[x / kCell]; });
  return kept;
}

}  // namespace gradus::reconstruct
