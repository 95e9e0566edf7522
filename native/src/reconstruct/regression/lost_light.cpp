#include "reconstruct/regression/lost_light.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"

namespace gradus::reconstruct {
namespace {

// Light is summed over squares of (2 · kLossRadius + 1)² cells of kLossCell × kLossCell pixels. Smaller squares bring
// light of bright places to the dark ones beside them.
constexpr int kLossCell = 32, kLossRadius = 4;
// Radius of the light relative to which noise is, and maximum of that ratio.
constexpr int kLossLightRadius = 7;
constexpr float kMaxNoise = 16.0f;
// Bounds of the factors: where little of a square is noisy, the noisy pixels would take what all of it lacks.
constexpr float kMinFactor = 0.5f, kMaxFactor = 2.0f;
// Order of the sums: light that is lost, light · √(noise/light around), d².
constexpr int kLostSum = 0, kPlaceSum = 3, kSquareSum = 6;

// Returns √(noise/light around) of each pixel.
Field places_of_loss(const Field& regressed, const Field& noise) {
  const Field light = box_mean(
      make_field(regressed.width(), regressed.height(), [&](int x, int y) { return brightness_of(regressed, x, y); }),
      kLossLightRadius);
  return make_field(regressed.width(), regressed.height(), [&](int x, int y) {
    const float around = light.row(y)[x], ratio = around > 0.0f ? noise.row(y)[x] / around : 0.0f;
    return std::sqrt(std::clamp(ratio, 0.0f, kMaxNoise));
  });
}

// Returns the sums over cells.
Field sum_loss(const Field& expected, const Field& places, const LightOfSamples& samples) {
  const int w = expected.width(), h = expected.height();
  Field sums((w + kLossCell - 1) / kLossCell, (h + kLossCell - 1) / kLossCell, kSquareSum + 1);
  const auto add_row = [&](int y) {
    const int j = y / kLossCell;
    const float *share = samples.share.row(y), *place = places.row(y), *variance = samples.variance.row(y);
    for (int x = 0; x < w; ++x) sums.row(j, kSquareSum)[x / kLossCell] += variance[x];
    for (int c = 0; c < 3; ++c) {
      const float *light = samples.light.row(y, c), *there = expected.row(y, c);
      for (int x = 0; x < w; ++x) {
        sums.row(j, kLostSum + c)[x / kLossCell] += light[x] - share[x] * there[x];
        sums.row(j, kPlaceSum + c)[x / kLossCell] += share[x] * place[x] * there[x];
      }
    }
  };
  for_rows(
      sums.height(),
      [&](int j) {
        for (int y = j * kLossCell; y < std::min(h, (j + 1) * kLossCell); ++y) add_row(y);
      },
      1);
  return sums;
}

// Returns the light to restore over light · √(noise/light around), for each cell.
Field restored_shares(const Field& sums) {
  const Field means = box_mean(sums, kLossRadius);
  Field shares(sums.width(), sums.height(), 3);
  for_values(&shares, [&](float& value, int x, int y, int c) {
    float squared = 0.0f;
    for (int i = 0; i < 3; ++i) squared += means.row(y, kLostSum + i)[x] * means.row(y, kLostSum + i)[x] / 3.0f;
    // These are means over n cells: the square of a sum is n² times that of the mean, a sum of squares n times theirs.
    squared *= float(count_within(x, kLossRadius, sums.width()) * count_within(y, kLossRadius, sums.height()));
    const float variance = means.row(y, kSquareSum)[x], places = means.row(y, kPlaceSum + c)[x];
    if (squared > variance && places > 0.0f)
      value = (1.0f - variance / squared) * means.row(y, kLostSum + c)[x] / places;
  });
  return shares;
}

// A pixel between the centres of two cells, along one axis.
struct BetweenCells {
  int first, second;
  float part;
  BetweenCells(int pixel, int cells) {
    const float at = (float(pixel) + 0.5f) / float(kLossCell) - 0.5f;
    first = std::clamp(int(std::floor(at)), 0, cells - 1);
    second = std::min(first + 1, cells - 1);
    part = std::clamp(at - float(first), 0.0f, 1.0f);
  }
};

float interpolate_cells(const Field& cells, int channel, const BetweenCells& x, const BetweenCells& y) {
  const float *above = cells.row(y.first, channel), *below = cells.row(y.second, channel);
  const float a = above[x.first] + x.part * (above[x.second] - above[x.first]),
              b = below[x.first] + x.part * (below[x.second] - below[x.first]);
  return a + y.part * (b - a);
}

}  // namespace

Field restore_lost_light(const Field& regressed, const Field& expected, const Field& noise,
                         const LightOfSamples& samples) {
  const Field places = places_of_loss(regressed, noise);
  const Field shares = restored_shares(sum_loss(expected, places, samples));
  Field factors(regressed.width(), regressed.height(), 3);
  for_rows(factors.height(), [&](int y) {
    const BetweenCells of_y(y, shares.height());
    for (int x = 0; x < factors.width(); ++x) {
      const BetweenCells of_x(x, shares.width());
      for (int c = 0; c < 3; ++c) {
        const float restored = places.row(y)[x] * interpolate_cells(shares, c, of_x, of_y);
        factors.row(y, c)[x] =
            GRADUS_FAULT(lost_light_not_restored) ? 1.0f : std::clamp(1.0f + restored, kMinFactor, kMaxFactor);
      }
    }
  });
  return factors;
}

}  // namespace gradus::reconstruct
