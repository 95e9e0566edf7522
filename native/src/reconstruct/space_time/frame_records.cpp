#include "reconstruct/space_time/frame_records.h"

#include <algorithm>
#include <utility>

#include "base/rows.h"
#include "base/types.h"
#include "reconstruct/field_values.h"
#include "reconstruct/regression/feature_filter.h"
#include "reconstruct/regression/feature_regression.h"
#include "reconstruct/regularized.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {
namespace {

static_assert(kRecordDepth - kRecordFeatures == kDepth);

Field planes_of(const FrameRecords& frame, int first, int count) {
  Field planes(frame.width, frame.height, count);
  for_values(&planes, [&](float& value, int x, int y, int c) { value = frame.at(y * frame.width + x)[first + c]; });
  return planes;
}

std::vector<AlphaRecord> read_alpha(const film::Film& film) {
  const HalvedImage alpha = read_halves(film, [&](size_t i) {
    HalfSums sums{};
    for (const film::ComponentPlanes& component : film.components) {
      for (size_t half = 0; half < film::kHalves; ++half) sums[half] += Rgb(component.primal[half][i][3]);
    }
    return sums;
  });
  std::vector<AlphaRecord> records(size_t(alpha.mean.width()) * size_t(alpha.mean.height()));
  for_rows(alpha.mean.height(), [&](int y) {
    AlphaRecord* to = records.data() + size_t(y) * size_t(alpha.mean.width());
    for (int x = 0; x < alpha.mean.width(); ++x)
      to[x] = {alpha.mean.row(y)[x], mean_of_squares(alpha.half_difference, x, y)};
  });
  return records;
}

}  // namespace

FrameRecords read_records(const film::Film& film) {
  const film::Features features = filter_features(film::read_features(film));
  HalvedImage image = read_sum(film);
  FrameRecords frame;
  frame.width = features.width;
  frame.height = features.height;
  frame.scale = robust_scale(image.mean);
  frame.has_differences = film.gradients;
  frame.typical_depth = typical_depth(features);
  HalvedImage relative = image;
  normalise(frame.scale, &relative);
  const Field basis = regression_features(features, 1.0f);
  const PixelWeights weights = weigh_pixels(relative);
  const float largest = std::min(kMaxInMedians * frame.scale, kMaxFloat);
  frame.pixels.resize(size_t(frame.width) * size_t(frame.height));
  for_rows(frame.height, [&](int y) {
    for (int x = 0; x < frame.width; ++x) {
      const size_t i = size_t(y) * size_t(frame.width) + size_t(x);
      float* to = frame.pixels[i].values;
      for (int c = 0; c < 3; ++c) {
        to[kRecordMean + c] = std::clamp(image.mean.row(y, c)[x], -largest, largest);
        to[kRecordHalfDifference + c] = std::clamp(image.half_difference.row(y, c)[x], -largest, largest);
      }
      for (int c = 0; c < kDepth; ++c) to[kRecordFeatures + c] = basis.row(y, c)[x];
      to[kRecordDepth] = is_finite(features.depth.values[i]) ? features.depth.values[i] : 0.0f;
      to[kRecordWeight] = weights.in_windows.row(y)[x];
      to[kRecordOwnWeight] = weights.own.row(y)[x];
      to[kRecordVariance] = mean_of_squares(relative.half_difference, x, y);
    }
  });
  if (film.color_channels > 3) frame.alpha = read_alpha(film);
  if (film.components.size() > 1 || film.color_channels > 3) {
    for (size_t k = 0; k < film.components.size(); ++k) frame.components.push_back(read_sampled(film, int(k), 1.0f));
  }
  return frame;
}

HalvedImage image_of(const FrameRecords& frame) {
  HalvedImage image{planes_of(frame, kRecordMean, 3), planes_of(frame, kRecordHalfDifference, 3)};
  normalise(frame.scale, &image);
  return image;
}

std::vector<Field> components_of(const FrameRecords& frame) {
  std::vector<Field> components = frame.components;
  for (Field& component : components) scale_light(1.0f / frame.scale, &component);
  return components;
}

Field features_of(const FrameRecords& frame) {
  Field features = planes_of(frame, kRecordFeatures, kFeatureChannels);
  for_rows(frame.height, [&](int y) {
    float* depths = features.row(y, kDepth);
    for (int x = 0; x < frame.width; ++x) depths[x] = relative_depth(depths[x], frame.typical_depth);
  });
  return features;
}

Field plane_of(const FrameRecords& frame, RecordValue value) { return planes_of(frame, value, 1); }

}  // namespace gradus::reconstruct
