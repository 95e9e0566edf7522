#include "reconstruct/local_light.h"

#include <algorithm>

#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {

Field squared_light(const Field& image, int radius) {
  Field light = box_mean(
      make_field(image.width(), image.height(), [&](int x, int y) { return std::max(mean_of(image, x, y), 0.0f); }),
      radius);
  for_values(&light, [](float& value, int, int, int) { value = (value + kDark) * (value + kDark); });
  return light;
}

}  // namespace gradus::reconstruct
