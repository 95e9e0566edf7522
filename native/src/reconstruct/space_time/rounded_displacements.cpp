#include "reconstruct/space_time/rounded_displacements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/cubic_weights.h"
#include "base/rows.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

// Neighbours whose ways differ by more, in pixels, belong to something else, which goes elsewhere.
constexpr float kTogether = 0.5f;
constexpr int kTaps = 4;
constexpr int kShareRadius = 7;
constexpr int kColors = 3;

struct Displacements {
  std::vector<Vec2> off_centre, whole;
  std::vector<bool> linked;
};

Displacements read_displacements(const CorrespondenceMap& correspondence, const HalvedWindowSource& source, int t) {
  const auto width = size_t(correspondence.width()), pixels = width * size_t(correspondence.height());
  Displacements ways{std::vector<Vec2>(pixels), std::vector<Vec2>(pixels), std::vector<bool>(pixels, false)};
  for (int y = 0; y < correspondence.height(); ++y) {
    const size_t first = size_t(y) * width;
    source.read_off_centre(t, y, ways.off_centre.data() + first);
    correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
      for (size_t i = first + size_t(begin); i < first + size_t(end); ++i) {
        ways.whole[i] = Vec2(float(dx), float(dy)) + ways.off_centre[i];
        ways.linked[i] = true;
      }
    });
  }
  return ways;
}

// Weights of the pixels around one, by which the picture there is that of a place beside its middle.
struct Lookup {
  std::array<size_t, kTaps * kTaps> x{}, y{};
  std::array<float, kTaps * kTaps> weight{};
};

Lookup look_up(const Displacements& ways, int x, int y, int width, int height) {
  const size_t here = size_t(y) * size_t(width) + size_t(x);
  const Vec2 from = -ways.off_centre[here], before = glm::floor(from);
  const std::array<float, kTaps> wx = cubic_weights(from.x - before.x), wy = cubic_weights(from.y - before.y);
  Lookup lookup;
  for (size_t k = 0; k < size_t(kTaps * kTaps); ++k) {
    const int column = std::clamp(x + int(before.x) + int(k % kTaps) - 1, 0, width - 1),
              row = std::clamp(y + int(before.y) + int(k / kTaps) - 1, 0, height - 1);
    const size_t there = size_t(row) * size_t(width) + size_t(column);
    const Vec2 apart = glm::abs(ways.whole[there] - ways.whole[here]);
    const bool together = ways.linked[there] && apart.x <= kTogether && apart.y <= kTogether;
    lookup.x[k] = size_t(together ? column : x);
    lookup.y[k] = size_t(together ? row : y);
    lookup.weight[k] = wx[k % kTaps] * wy[k / kTaps];
  }
  return lookup;
}

}  // namespace

Field rounding_change(const Field& picture, const CorrespondenceMap& correspondence, const HalvedWindowSource& source,
                      int t) {
  const int width = picture.width(), height = picture.height();
  const Displacements ways = read_displacements(correspondence, source, t);
  Field change(width, height, picture.channels());
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const size_t here = size_t(y) * size_t(width) + size_t(x);
      if (!ways.linked[here] || ways.off_centre[here] == Vec2(0.0f)) continue;
      const Lookup lookup = look_up(ways, x, y, width, height);
      for (int c = 0; c < picture.channels(); ++c) {
        float sum = 0.0f;
        for (size_t k = 0; k < lookup.weight.size(); ++k)
          sum += lookup.weight[k] * picture.row(int(lookup.y[k]), c)[lookup.x[k]];
        change.row(y, c)[x] = sum - picture.row(y, c)[x];
      }
    }
  });
  return change;
}

void keep_sampled_share(const Field& sampled, Field* rounding) {
  const auto product = [&](const Field& other) {
    return box_mean(make_field(rounding->width(), rounding->height(),
                               [&](int x, int y) {
                                 float sum = 0.0f;
                                 for (int c = 0; c < kColors; ++c) sum += rounding->row(y, c)[x] * other.row(y, c)[x];
                                 return sum;
                               }),
                    kShareRadius);
  };
  const Field both = product(sampled), square = product(*rounding);
  for_values(rounding, [&](float& value, int x, int y, int) {
    const float share = square.row(y)[x] > 0.0f ? both.row(y)[x] / square.row(y)[x] : 0.0f;
    value *= std::clamp(share, 0.0f, 1.0f);
  });
}

}  // namespace gradus::reconstruct
