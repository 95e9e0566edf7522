#include "reconstruct/regression/restore_sampled_light.h"

#include <algorithm>
#include <array>

#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

constexpr float kMinShare = 0.25f;

// Returns the median over those of the 3×3 pixels around (x, y) that lie in the image.
float median_around(const Field& image, int x, int y, int channel) {
  std::array<float, 9> values;
  size_t count = 0;
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, image.height() - 1); ++j) {
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, image.width() - 1); ++i)
      values[count++] = image.row(j, channel)[i];
  }
  std::nth_element(values.begin(), values.begin() + count / 2, values.begin() + count);
  return values[count / 2];
}

// Returns the share of the sampled value that moves one channel away from 0 to its minimum, a quarter of the sampled
// light. Light is negative where the pixels around are, too; a single negative value is noise.
float share_of_own(const Field& sampled, const Field& regressed, int x, int y, int channel) {
  const float sign = sampled.row(y, channel)[x] < 0.0f ? -1.0f : 1.0f;
  const float own = sign * sampled.row(y, channel)[x], value = sign * regressed.row(y, channel)[x];
  if (value >= kMinShare * own) return 0.0f;
  const float around = sign * median_around(sampled, x, y, channel);
  if (sign < 0.0f && around <= 0.0f) return 0.0f;
  const float minimum = kMinShare * std::min(own, around);
  return minimum > value ? (minimum - value) / (own - value) : 0.0f;
}

}  // namespace

Field restore_sampled_light(const Field& sampled, const Field& regressed) {
  return make_field(sampled.width(), sampled.height(), [&](int x, int y) {
    float share = 0.0f;
    for (int c = 0; c < sampled.channels(); ++c) share = std::max(share, share_of_own(sampled, regressed, x, y, c));
    return share;
  });
}

void blend_sampled(const Field& share, const Field& sampled, Field* regressed) {
  for_values(regressed,
             [&](float& value, int x, int y, int c) { value += share.row(y)[x] * (sampled.row(y, c)[x] - value); });
}

}  // namespace gradus::reconstruct
