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

// Neighbours whose displacements differ by more, in pixels, belong to another object.
constexpr float kMaxDifference = 0.5f;
constexpr int kTaps = 4;
constexpr int kShareRadius = 7;

// Displacements of all pixels to the next frame, in pixels.
struct Displacements {
  std::vector<Vec2> off_centre;  // the part that rounding to whole pixels has removed
  std::vector<Vec2> complete;    // the unrounded displacement
  std::vector<bool> is_known;    // whether the pixel has a correspondence
};

Displacements read_displacements(const CorrespondenceMap& correspondence, const HalvedWindowSource& source, int t) {
  const auto width = size_t(correspondence.width()), pixels = width * size_t(correspondence.height());
  Displacements displacements{std::vector<Vec2>(pixels), std::vector<Vec2>(pixels), std::vector<bool>(pixels, false)};
  for (int y = 0; y < correspondence.height(); ++y) {
    const size_t first = size_t(y) * width;
    source.read_off_centre(t, y, displacements.off_centre.data() + first);
    correspondence.for_runs(y, [&](int begin, int end, int dx, int dy) {
      for (size_t i = first + size_t(begin); i < first + size_t(end); ++i) {
        displacements.complete[i] = Vec2(float(dx), float(dy)) + displacements.off_centre[i];
        displacements.is_known[i] = true;
      }
    });
  }
  return displacements;
}

// Positions and weights of the pixels that interpolate the picture at a place beside the centre of a pixel.
struct Lookup {
  std::array<size_t, kTaps * kTaps> x{}, y{};
  std::array<float, kTaps * kTaps> weight{};
};

Lookup look_up(const Displacements& displacements, int x, int y, int width, int height) {
  const size_t here = size_t(y) * size_t(width) + size_t(x);
  const Vec2 from = -displacements.off_centre[here], before = glm::floor(from);
  const std::array<float, kTaps> wx = cubic_weights(from.x - before.x), wy = cubic_weights(from.y - before.y);
  Lookup lookup;
  for (size_t k = 0; k < size_t(kTaps * kTaps); ++k) {
    const int column = std::clamp(x + int(before.x) + int(k % kTaps) - 1, 0, width - 1),
              row = std::clamp(y + int(before.y) + int(k / kTaps) - 1, 0, height - 1);
    const size_t there = size_t(row) * size_t(width) + size_t(column);
    const Vec2 difference = glm::abs(displacements.complete[there] - displacements.complete[here]);
    const bool is_same_object =
        displacements.is_known[there] && difference.x <= kMaxDifference && difference.y <= kMaxDifference;
    lookup.x[k] = size_t(is_same_object ? column : x);
    lookup.y[k] = size_t(is_same_object ? row : y);
    lookup.weight[k] = wx[k % kTaps] * wy[k / kTaps];
  }
  return lookup;
}

}  // namespace

Field rounding_change(const Field& picture, const CorrespondenceMap& correspondence, const HalvedWindowSource& source,
                      int t) {
  const int width = picture.width(), height = picture.height();
  const Displacements displacements = read_displacements(correspondence, source, t);
  Field change(width, height, picture.channels());
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const size_t here = size_t(y) * size_t(width) + size_t(x);
      if (!displacements.is_known[here] || displacements.off_centre[here] == Vec2(0.0f)) continue;
      const Lookup lookup = look_up(displacements, x, y, width, height);
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
