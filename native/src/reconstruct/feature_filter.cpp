#include "reconstruct/feature_filter.h"

#include <algorithm>
#include <cmath>

#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"
#include "reconstruct/solver_planes.h"

namespace gradus {
namespace {

constexpr int kPatchRadius = 1, kVarianceRadius = 1;
// k²: squared differences are measured in this many variances (docs/method.md has what was tried).
constexpr float kVariances = 0.5f;
// Differences below this share of the feature's typical magnitude are none.
constexpr float kNegligible = 5e-3f;
// Every so many values are looked at for that; not a multiple of the channels.
constexpr size_t kStride = 7;
constexpr float kLargest = 1e15f, kLargestVariance = 1e30f, kLeast = 1e-30f;

struct Neighbour {
  int x, y;
};
// Half of the neighbours: distances are symmetric.
constexpr Neighbour kNeighbours[] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};

Field load(const std::vector<float>& values, int width, int height, int channels, float least, float most) {
  Field field(width, height, channels);
  for_values(&field, [&](float& value, int x, int y, int c) {
    const float stored = values[(size_t(y) * size_t(width) + size_t(x)) * size_t(channels) + size_t(c)];
    value = is_finite(stored) ? std::clamp(stored, least, most) : 0.0f;
  });
  return field;
}

// Median of the magnitudes that are not 0, which a few that are far off do not change; from a part of them.
float typical(const std::vector<float>& values) {
  std::vector<float> magnitudes;
  for (size_t i = 0; i < values.size(); i += kStride) {
    if (is_finite(values[i]) && values[i] != 0.0f) magnitudes.push_back(std::fabs(values[i]));
  }
  return std::min(median_or_one(&magnitudes), kLargest);
}

// By how much the squared difference of p and p + offset exceeds what noise explains, in variances, mean over the channels; 0 where there
// is no such pixel.
Field distances(const Field& values, const Field& variance, Neighbour offset, float negligible) {
  const int w = values.width(), h = values.height(), channels = values.channels();
  const float share = 1.0f / static_cast<float>(channels);
  Field result(w, h, 1);
  for_rows(h - offset.y, [&](int y) {
    const int begin = std::max(0, -offset.x), end = std::min(w, w - offset.x);
    float* to = result.row(y);
    for (int c = 0; c < channels; ++c) {
      const float *a = values.row(y, c), *b = values.row(y + offset.y, c) + offset.x;
      const float *of_a = variance.row(y, c), *of_b = variance.row(y + offset.y, c) + offset.x;
      for (int x = begin; x < end; ++x) {
        const float difference = a[x] - b[x], noise = of_a[x] + of_b[x];
        to[x] += share * (difference * difference - noise) / (negligible + kVariances * noise);
      }
    }
  });
  return result;
}

// About exp(-distance).
float weight_of(float distance) {
  const float t = 1.0f + 0.25f * std::max(distance, 0.0f), squared = t * t;
  return 1.0f / (squared * squared);
}

// Adds to each pixel its neighbours at offset and at -offset.
void gather(const Field& values, const Field& distance, Neighbour offset, Field* sum, Field* weights) {
  const int w = values.width(), h = values.height();
  for_rows(h, [&](int y) {
    for (const int sign : {1, -1}) {
      const int other = y + sign * offset.y;
      if (other < 0 || other >= h) continue;
      const int step = sign * offset.x, begin = std::max(0, -step), end = std::min(w, w - step);
      const float* d = sign > 0 ? distance.row(y) : distance.row(other) + step;
      for (int x = begin; x < end; ++x) {
        const float weight = weight_of(d[x]);
        weights->row(y)[x] += weight;
        for (int c = 0; c < values.channels(); ++c) sum->row(y, c)[x] += weight * values.row(other, c)[x + step];
      }
    }
  });
}

}  // namespace

FeatureImage filter_feature(FeatureImage image, int width, int height) {
  const int channels = int(image.channels);
  const Field values = load(image.values, width, height, channels, -kLargest, kLargest);
  const Field variance = box_mean(load(image.variance, width, height, channels, 0.0f, kLargestVariance), kVarianceRadius);
  const float unit = kNegligible * typical(image.values), negligible = std::max(kLeast, unit * unit);
  Field sum = values, weights(width, height, 1);
  for_values(&weights, [](float& weight, int, int, int) { weight = 1.0f; });
  for (const Neighbour offset : kNeighbours) {
    if (offset.y >= height || std::abs(offset.x) >= width) continue;
    gather(values, box_mean(distances(values, variance, offset, negligible), kPatchRadius), offset, &sum, &weights);
  }
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        image.values[(size_t(y) * size_t(width) + size_t(x)) * size_t(channels) + size_t(c)] = sum.row(y, c)[x] / weights.row(y)[x];
      }
    }
  });
  return image;
}

Features filter_features(Features features) {
  for (FeatureImage* image : {&features.normal, &features.albedo, &features.depth}) {
    *image = filter_feature(std::move(*image), features.width, features.height);
  }
  return features;
}

}  // namespace gradus
