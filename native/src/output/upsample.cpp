#include "output/upsample.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

namespace gradus::output {
namespace {

// Returns, along one axis, the position of the centre of pixel i of `full` among the pixel centres of `small`.
double position(int32_t i, uint32_t full, uint32_t small) { return (i + 0.5) * double(small) / double(full) - 0.5; }

// Two neighbouring pixels, clamped to [begin, end) and counted from `begin`, and the weight of the second.
struct Between {
  int32_t first, second;
  float share;
};

Between between(double position, int32_t begin, int32_t end) {
  const double floor = std::floor(position);
  const auto i = int32_t(floor);
  return {std::clamp(i, begin, end - 1) - begin, std::clamp(i + 1, begin, end - 1) - begin, float(position - floor)};
}

}  // namespace

Region covering(const Region& region, ImageSize full, ImageSize small) {
  const auto first = [](int32_t i, uint32_t of, uint32_t to) {
    return std::max(0, int32_t(std::floor(position(i, of, to))));
  };
  const auto end = [](int32_t i, uint32_t of, uint32_t to) {
    return std::min(int32_t(to), int32_t(std::floor(position(i - 1, of, to))) + 2);
  };
  return {first(region.x0, full.width, small.width), first(region.y0, full.height, small.height),
          end(region.x1, full.width, small.width), end(region.y1, full.height, small.height)};
}

std::vector<float> enlarge(const std::vector<float>& image, size_t channels, const Region& region, ImageSize full,
                           ImageSize small) {
  const Region from = covering(region, full, small);
  std::vector<Between> columns;
  for (int32_t x = region.x0; x < region.x1; ++x)
    columns.push_back(between(position(x, full.width, small.width), from.x0, from.x1));
  std::vector<float> result(channels * size_t(region.area()));
  tbb::parallel_for(region.y0, region.y1, [&](int32_t y) {
    const Between rows = between(position(y, full.height, small.height), from.y0, from.y1);
    const float* const below = image.data() + channels * size_t(rows.first) * size_t(from.width());
    const float* const above = image.data() + channels * size_t(rows.second) * size_t(from.width());
    float* to = result.data() + channels * size_t(y - region.y0) * size_t(region.width());
    for (const Between& column : columns) {
      const size_t left = channels * size_t(column.first), right = channels * size_t(column.second);
      for (size_t c = 0; c < channels; ++c) {
        const float lower = below[left + c] + column.share * (below[right + c] - below[left + c]);
        const float upper = above[left + c] + column.share * (above[right + c] - above[left + c]);
        *to++ = lower + rows.share * (upper - lower);
      }
    }
  });
  return result;
}

}  // namespace gradus::output
