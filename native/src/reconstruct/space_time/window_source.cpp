#include "reconstruct/space_time/window_source.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace gradus {

void HalvedWindowSource::read_deviations(RowKind kind, int t, int y, float* out) const {
  const size_t width = size_t(size().width), channels = size_t(size().channels);
  std::vector<float> halves(width * channels);
  read_half_differences(kind, t, y, halves.data());
  for (size_t x = 0; x < width; ++x) {
    const float* d = halves.data() + x * channels;
    out[x] = std::sqrt((d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / 3.0f);
  }
}

void HalvedWindowSource::read_off_centre(int, int, Vec2* out) const { std::fill_n(out, size().width, Vec2(0.0f)); }

}  // namespace gradus
