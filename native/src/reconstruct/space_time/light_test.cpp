#include "reconstruct/space_time/light_test.h"

#include <algorithm>

#include "base/fault.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

// Radii of the squares around each pixel, in pixels, and of larger ones around cells of kCell × kCell pixels, in cells.
constexpr int kRadii[] = {2, 4}, kRadiiOfCells[] = {2, 4, 8};
constexpr int kCell = 4;
// The samples of a square count in full if the squared mean difference is at most kSame times its variance, and not at
// all from kOther times on.
constexpr float kSame = 6.0f, kOther = 12.0f;
constexpr int kVariance = 3;  // channel of the variance among the sums

// Returns the terms of a square's mean difference and of its variance: w d for each channel, and Σ w² v over them.
Field terms_of(const LightChange& change) {
  Field terms(change.weight.width(), change.weight.height(), kVariance + 1);
  for_values(&terms, [&](float& value, int x, int y, int c) {
    const float w = change.weight.row(y)[x];
    value = c < kVariance ? w * change.difference.row(y, c)[x] : 3.0f * w * w * mean_of(change.variance, x, y);
  });
  return terms;
}

Field sum_cells(const Field& image) {
  Field cells((image.width() + kCell - 1) / kCell, (image.height() + kCell - 1) / kCell, image.channels());
  for_values(&cells, [&](float& value, int x, int y, int c) {
    for (int j = y * kCell; j < std::min(image.height(), (y + 1) * kCell); ++j) {
      for (int i = x * kCell; i < std::min(image.width(), (x + 1) * kCell); ++i) value += image.row(j, c)[i];
    }
  });
  return cells;
}

// Returns the share of the weight that is kept by the test in squares of this radius.
Field test(const Field& terms, int radius) {
  const Field means = box_mean(terms, radius);
  return make_field(terms.width(), terms.height(), [&](int x, int y) {
    const int count = count_within(x, radius, terms.width()) * count_within(y, radius, terms.height());
    float square = 0.0f;
    for (int c = 0; c < kVariance; ++c) square += means.row(y, c)[x] * means.row(y, c)[x];
    square *= float(count);
    const float variance = means.row(y, kVariance)[x];
    if (square <= kSame * variance) return 1.0f;
    return variance > 0.0f ? std::max((kOther - square / variance) / (kOther - kSame), 0.0f) : 0.0f;
  });
}

}  // namespace

Field same_light(const LightChange& change) {
  const int w = change.weight.width(), h = change.weight.height();
  Field kept = make_field(w, h, [](int, int) { return 1.0f; });
  if (GRADUS_FAULT(light_test_off)) return kept;
  const Field terms = terms_of(change), cells = sum_cells(terms);
  Field of_cells = make_field(cells.width(), cells.height(), [](int, int) { return 1.0f; });
  for (const int radius : kRadii) scale_by(test(terms, radius), &kept);
  for (const int radius : kRadiiOfCells) scale_by(test(cells, radius), &of_cells);
  for_values(&kept, [&](float& value, int x, int y, int) { value *= of_cells.row(y / kCell)[x / kCell]; });
  return kept;
}

}  // namespace gradus::reconstruct
