#include "reconstruct/regression/halved_image.h"

#include <algorithm>

#include "base/types.h"
#include "reconstruct/box_mean.h"

namespace gradus::reconstruct {
namespace {

bool is_known(const Field& field) {
  for (int y = 0; y < field.height(); ++y) {
    for (int c = 0; c < field.channels(); ++c) {
      const float* row = field.row(y, c);
      if (!std::all_of(row, row + field.width(), [](float value) { return is_finite(value); })) return false;
    }
  }
  return true;
}

}  // namespace

void guess_noise(HalvedImage* image) {
  if (is_known(image->half_difference)) return;
  const Field around = box_mean(image->mean, 1);
  for_values(&image->half_difference, [&](float& value, int x, int y, int c) {
    if (!is_finite(value)) value = image->mean.row(y, c)[x] - around.row(y, c)[x];
  });
}

void normalise(float scale, HalvedImage* image) {
  for (Field* field : {&image->mean, &image->half_difference}) {
    for_values(field, [scale](float& value, int, int, int) {
      value = std::clamp(value / scale, -kMaxInMedians, kMaxInMedians);
    });
  }
}

}  // namespace gradus::reconstruct
