#include "reconstruct/space_time/light_test.h"

#include <algorithm>

#include "base/fault.h"
#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

// Radii of the squares around each cell, in cells, and of larger ones around two by two cells, in units of these.
constexpr int kRadii[] = {1, 2}, kLargeRadii[] = {2, 4, 8};
// The samples of a square count in full if the squared mean difference is at most kSame times its variance, and not at
// all from kOther times on.
constexpr float kSame = 6.0f, kOther = 12.0f;

// Returns the sums over two by two cells.
Field sum_cells(const Field& cells) {
  Field sums((cells.width() + 1) / 2, (cells.height() + 1) / 2, cells.channels());
  for_values(&sums, [&](float& value, int x, int y, int c) {
    for (int j = 2 * y; j < std::min(cells.height(), 2 * y + 2); ++j) {
      for (int i = 2 * x; i < std::min(cells.width(), 2 * x + 2); ++i) value += cells.row(j, c)[i];
    }
  });
  return sums;
}

// Returns the share of the weight that is kept by the test in squares of this radius.
Field test(const Field& changes, int radius) {
  const Field means = box_mean(changes, radius);
  return make_field(changes.width(), changes.height(), [&](int x, int y) {
    const int count = count_within(x, radius, changes.width()) * count_within(y, radius, changes.height());
    float square = 0.0f;
    for (int c = 0; c < kChangeVariance; ++c) square += means.row(y, c)[x] * means.row(y, c)[x];
    square *= float(count);
    const float variance = means.row(y, kChangeVariance)[x];
    if (!is_finite(square)) return 0.0f;
    if (square <= kSame * variance) return 1.0f;
    return variance > 0.0f ? std::max((kOther - square / variance) / (kOther - kSame), 0.0f) : 0.0f;
  });
}

// Tests squares of growing radii around each cell. What a smaller square drops in full does not count in the larger
// ones, so that they keep what is the same beside it. Returns the share of each cell that all of them keep.
template <size_t N>
Field test_all(const int (&radii)[N], Field* changes) {
  Field kept = make_field(changes->width(), changes->height(), [](int, int) { return 1.0f; });
  for (const int radius : radii) {
    const Field share = test(*changes, radius);
    scale_by(share, &kept);
    for_values(changes, [&](float& value, int x, int y, int) { value = share.row(y)[x] > 0.0f ? value : 0.0f; });
  }
  return kept;
}

}  // namespace

Field same_light(Field changes) {
  if (GRADUS_FAULT(light_test_off)) return make_field(changes.width(), changes.height(), [](int, int) { return 1.0f; });
  Field kept = test_all(kRadii, &changes), large = sum_cells(changes);
  const Field of_large = test_all(kLargeRadii, &large);
  for_values(&kept, [&](float& value, int x, int y, int) { value *= of_large.row(y / 2)[x / 2]; });
  return kept;
}

}  // namespace gradus::reconstruct
