#include "reconstruct/regression/feature_filter.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "base/rows.h"
#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {
namespace {

// Radius of a patch, 3×3 pixels, and of the window over which variances are averaged.
constexpr int kPatch = 1;
// Distance up to which pixels affect a pixel: its neighbours, their patches, and the window of the patches' variances.
constexpr int kFilterReach = 1 + 2 * kPatch;
// Size of a tile, so that it fits in the second-level cache. With its margin it is as tall as the rows of one thread
// (base/rows.h).
constexpr int kTileWidth = 250, kTileHeight = 26;
// k² of NL-means: the unit of squared differences in variances.
constexpr float kVariances = 0.5f;
// Differences below this share of the feature's typical magnitude count as 0.
constexpr float kNegligible = 5e-3f;
// The typical magnitude is the median of every kStride-th value. Not a multiple of the number of channels.
constexpr size_t kStride = 7;
constexpr float kLargest = 1e15f, kLargestVariance = 1e30f, kMin = 1e-30f;

struct Neighbour {
  int x, y;
};
// Half of the eight neighbours: distances are symmetric.
constexpr Neighbour kNeighbours[] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};

// A rectangle of pixels.
struct Part {
  int x0, y0, x1, y1;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

Field load(const std::vector<float>& values, int image_width, const Part& part, int channels, float minimum,
           float maximum) {
  Field field(part.width(), part.height(), channels);
  for (int y = 0; y < part.height(); ++y) {
    const float* from =
        values.data() + (size_t(part.y0 + y) * size_t(image_width) + size_t(part.x0)) * size_t(channels);
    for (int c = 0; c < channels; ++c) {
      float* to = field.row(y, c);
      for (int x = 0; x < part.width(); ++x) {
        const float stored = from[size_t(x) * size_t(channels) + size_t(c)];
        to[x] = is_finite(stored) ? std::clamp(stored, minimum, maximum) : 0.0f;
      }
    }
  }
  return field;
}

// Returns the median of the magnitudes that are not 0, which outliers hardly change, from a subset of the values.
float typical(const std::vector<float>& values) {
  std::vector<float> magnitudes;
  for (size_t i = 0; i < values.size(); i += kStride) {
    if (is_finite(values[i]) && values[i] != 0.0f) magnitudes.push_back(std::fabs(values[i]));
  }
  return std::min(median_or_one(&magnitudes), kLargest);
}

// Returns the first column that has a neighbour at `offset`.
int first_column(Neighbour offset) { return std::max(0, -offset.x); }

// Returns how far the squared difference of p and p + offset exceeds what noise explains, in variances, mean over the
// channels. The field has one value for each pair in the image; the first one is at the lower left.
Field distances(const Field& values, const Field& variance, Neighbour offset, float negligible) {
  const int channels = values.channels(), begin = first_column(offset);
  const float share = 1.0f / static_cast<float>(channels);
  Field result(values.width() - std::abs(offset.x), values.height() - offset.y, 1);
  for_rows(result.height(), [&](int y) {
    float* to = result.row(y);
    for (int c = 0; c < channels; ++c) {
      const float *a = values.row(y, c) + begin, *b = values.row(y + offset.y, c) + begin + offset.x;
      const float *of_a = variance.row(y, c) + begin, *of_b = variance.row(y + offset.y, c) + begin + offset.x;
      for (int x = 0; x < result.width(); ++x) {
        const float factor = GRADUS_FAULT(filter_variance_times_4)  ? 4.0f
                             : GRADUS_FAULT(filter_variance_over_4) ? 0.25f
                                                                    : 1.0f;
        const float difference = a[x] - b[x], noise = factor * (of_a[x] + of_b[x]);
        to[x] += share * (difference * difference - noise) / (negligible + kVariances * noise);
      }
    }
  });
  return result;
}

// Returns an approximation of exp(-distance).
float weight_of(float distance) {
  const float t = 1.0f + 0.25f * std::max(distance, 0.0f), squared = t * t;
  return 1.0f / (squared * squared);
}

// Adds to each pixel its neighbours at `offset` and at -`offset`, by their weights.
void gather(const Field& values, const Field& distance, Neighbour offset, Field* sum, Field* weights) {
  const int w = values.width(), h = values.height();
  for_rows(h, [&](int y) {
    for (const int sign : {1, -1}) {
      const int other = y + sign * offset.y;
      if (other < 0 || other >= h) continue;
      const int step = sign * offset.x, begin = std::max(0, -step), end = std::min(w, w - step);
      const float* d =
          sign > 0 ? distance.row(y) - first_column(offset)
                   : distance.row(other) + (GRADUS_FAULT(filter_distances_shifted) ? 0 : step) - first_column(offset);
      for (int x = begin; x < end; ++x) {
        const float weight = weight_of(d[x]);
        weights->row(y)[x] += weight;
        for (int c = 0; c < values.channels(); ++c) sum->row(y, c)[x] += weight * values.row(other, c)[x + step];
      }
    }
  });
}

// Filters one tile: reads it with a margin of kFilterReach pixels and writes its own pixels.
void filter_tile(const film::FeatureImage& image, int width, int height, const Part& tile, float negligible,
                 std::vector<float>* result) {
  const Part all{std::max(0, tile.x0 - kFilterReach), std::max(0, tile.y0 - kFilterReach),
                 std::min(width, tile.x1 + kFilterReach), std::min(height, tile.y1 + kFilterReach)};
  const int channels = int(image.channels);
  const Field values = load(image.values, width, all, channels, -kLargest, kLargest);
  const Field variance = box_mean(load(image.variance, width, all, channels, 0.0f, kLargestVariance), kPatch);
  Field sum = values, weights(all.width(), all.height(), 1);
  for (int y = 0; y < all.height(); ++y) std::fill_n(weights.row(y), all.width(), 1.0f);
  for (const Neighbour offset : kNeighbours) {
    if (offset.y >= all.height() || std::abs(offset.x) >= all.width()) continue;
    gather(values, box_mean(distances(values, variance, offset, negligible), kPatch), offset, &sum, &weights);
  }
  for (int y = tile.y0; y < tile.y1; ++y) {
    float* to = result->data() + (size_t(y) * size_t(width) + size_t(tile.x0)) * size_t(channels);
    for (int x = tile.x0; x < tile.x1; ++x) {
      const float share = 1.0f / weights.row(y - all.y0)[x - all.x0];
      for (int c = 0; c < channels; ++c) *to++ = share * sum.row(y - all.y0, c)[x - all.x0];
    }
  }
}

}  // namespace

film::FeatureImage filter_feature(film::FeatureImage image, int width, int height) {
  const float unit = kNegligible * typical(image.values), negligible = std::max(kMin, unit * unit);
  std::vector<float> result(image.values.size());
  for_rows((height + kTileHeight - 1) / kTileHeight,
           [&](int j) {
             const int y = j * kTileHeight;
             for (int x = 0; x < width; x += kTileWidth) {
               filter_tile(image, width, height,
                           {x, y, std::min(width, x + kTileWidth), std::min(height, y + kTileHeight)}, negligible,
                           &result);
             }
           },
           1);
  image.values = std::move(result);
  return image;
}

film::Features filter_features(film::Features features) {
  for (film::FeatureImage* image : {&features.normal, &features.albedo, &features.depth}) {
    *image = filter_feature(std::move(*image), features.width, features.height);
  }
  return features;
}

}  // namespace gradus::reconstruct
