#include "reconstruct/presence.h"

#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus {

Presence::Presence(const Features& features) {
  if (features.present.empty()) return;
  present_ = make_field(features.width, features.height,
                        [&](int x, int y) { return float(features.present[size_t(y) * size_t(features.width) + size_t(x)]); });
}

void Presence::mask(Field* values) const {
  if (present_.width() == 0) return;
  for_values(values, [&](float& value, int x, int y, int) { value *= present_.row(y)[x]; });
}

Field Presence::mean_around(const Field& values, int radius) const {
  Field mean = box_mean(values, radius);
  if (present_.width() == 0) return mean;
  const Field share = box_mean(present_, radius);
  for_values(&mean, [&](float& value, int x, int y, int) { value = share.row(y)[x] > 0.0f ? value / share.row(y)[x] : 0.0f; });
  return mean;
}

}  // namespace gradus
