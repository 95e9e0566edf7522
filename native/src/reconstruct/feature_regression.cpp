#include "reconstruct/feature_regression.h"

#include <algorithm>
#include <cmath>

#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/field_values.h"
#include "reconstruct/solver_planes.h"
#include "reconstruct/twicing.h"

namespace gradus {
namespace {

// Figures of this file: docs/method.md, "Regression on features".
const RegressionSettings kByFeatures{.radii = {1, 2, 4}, .coordinates = true, .ridge = 3e-4f, .floor = 1e-6f};
const RegressionSettings kOfResidual{.radii = {8}, .coordinates = false, .ridge = 1e-3f, .floor = 1e-6f};
// Pixels' noise is taken from a window, but where a pixel's own is far larger, as of a firefly.
constexpr int kNoiseRadius = 7;
constexpr float kOwnShare = 0.3f;
// Noise that is not told from none: a share of the light around, and one of the image's median luminance.
constexpr float kShareOfLight = 0.02f, kShareOfMedian = 0.01f;
// A pixel's own value counts by the noise around it and for this share, since the mean of windows is better than its parts; for less where
// it stands out, and where noise is above a tenth of the light: there both halves may have met the same firefly. kLeastVariance: of what
// shows none.
constexpr float kOwnTrust = 0.3f, kVisible = 0.1f, kLeastVariance = 1e-10f;
// Light around a pixel, by which residuals are measured.
constexpr int kLightRadius = 3;
// Side of squares that share a bound on outliers.
constexpr int kSquare = 16;

float mean_of_squares(const Field& field, int x, int y) {
  float sum = 0.0f;
  for (int c = 0; c < field.channels(); ++c) sum += field.row(y, c)[x] * field.row(y, c)[x];
  return sum / static_cast<float>(field.channels());
}

float mean_of(const Field& field, int x, int y) {
  float sum = 0.0f;
  for (int c = 0; c < field.channels(); ++c) sum += field.row(y, c)[x];
  return sum / static_cast<float>(field.channels());
}

// A field of one channel from function(x, y).
template <class Function>
Field make_field(int width, int height, const Function& function) {
  Field field(width, height, 1);
  for_values(&field, [&](float& value, int x, int y, int) { value = function(x, y); });
  return field;
}

// Of pixels: their weights in windows, and 1/variance.
struct PixelWeights {
  Field in_windows, own;
};

PixelWeights weigh_pixels(const HalvedImage& image) {
  const int w = image.mean.width(), h = image.mean.height();
  const Field own = make_field(w, h, [&](int x, int y) { return std::sqrt(mean_of_squares(image.half_difference, x, y)); });
  const Field noise = box_mean(own, kNoiseRadius);
  const Field light = box_mean(make_field(w, h, [&](int x, int y) { return std::fabs(mean_of(image.mean, x, y)); }), kNoiseRadius);
  return {make_field(w, h,
                     [&](int x, int y) {
                       const float around = noise.row(y)[x] + kShareOfLight * light.row(y)[x];
                       const float deviation = std::max(around, kOwnShare * own.row(y)[x]) + kShareOfMedian;
                       return 1.0f / (deviation * deviation);
                     }),
          make_field(w, h, [&](int x, int y) {
            const float usual = noise.row(y)[x], seen = own.row(y)[x], excess = usual > 0.0f ? std::max(1.0f, seen / usual) : 1.0f;
            const float relative = usual / (kVisible * light.row(y)[x] + kLeastVariance),
                        doubt = excess * excess * (1.0f + relative * relative);
            return kOwnTrust / (usual * usual * doubt * doubt + kLeastVariance);
          })};
}

// Median of the depths that are there; 1 without any.
float median_depth(const std::vector<float>& depths) {
  std::vector<float> there;
  std::copy_if(depths.begin(), depths.end(), std::back_inserter(there), [](float d) { return is_finite(d) && d > 0.0f; });
  return median_or_one(&there);
}

float bounded(float value) { return is_finite(value) ? std::clamp(value, -1.0f, 1.0f) : 0.0f; }

// Normal, albedo, and d/(d + median) of the depth, which does not depend on the scene's unit.
Field basis_of(const Features& features) {
  const float median = median_depth(features.depth.values);
  Field basis(features.width, features.height, 7);
  for_values(&basis, [&](float& value, int x, int y, int c) {
    const size_t i = size_t(y) * size_t(features.width) + size_t(x);
    const float depth = features.depth.values[i];
    value = c < 3   ? bounded(features.normal.values[3 * i + size_t(c)])
            : c < 6 ? bounded(features.albedo.values[3 * i + size_t(c - 3)])
                    : (depth > 0.0f ? bounded(depth / (depth + median)) : 0.0f);
  });
  return basis;
}

Field albedo_of(const Features& features) {
  Field albedo(features.width, features.height, 3);
  for_values(&albedo, [&](float& value, int x, int y, int c) {
    value = bounded(features.albedo.values[3 * (size_t(y) * size_t(features.width) + size_t(x)) + size_t(c)]);
  });
  return albedo;
}

// 1/light² around each pixel, so that residuals count by their share of it.
Field weigh_by_light(const Field& image) {
  const int w = image.width(), h = image.height();
  const Field light = box_mean(make_field(w, h, [&](int x, int y) { return std::max(mean_of(image, x, y), 0.0f); }), kLightRadius);
  return make_field(w, h, [&](int x, int y) {
    const float level = light.row(y)[x] + kShareOfLight;
    return 1.0f / (level * level);
  });
}

Field difference(const Field& a, const Field& b) {
  Field result = a;
  for_values(&result, [&](float& value, int x, int y, int c) { value -= b.row(y, c)[x]; });
  return result;
}

void add(const Field& other, Field* to) {
  for_values(to, [&](float& value, int x, int y, int c) { value += other.row(y, c)[x]; });
}

void scale_by(const Field& factors, Field* to) {
  for_values(to, [&](float& value, int x, int y, int) { value *= factors.row(y)[x]; });
}

// Share of each residual that lies within the bound of its square (reconstruct/twicing.h), relative to the light around it.
Field limit_outliers(const Field& residual, const Field& weights) {
  const int w = residual.width(), h = residual.height();
  Field share = make_field(w, h, [&](int x, int y) { return weights.row(y)[x] * mean_of_squares(residual, x, y); });
  for_rows((h + kSquare - 1) / kSquare,
           [&](int j) {
             for (int i = 0; i < (w + kSquare - 1) / kSquare; ++i) {
               limit_square(i * kSquare, std::min(w, (i + 1) * kSquare), j * kSquare, std::min(h, (j + 1) * kSquare), &share);
             }
           },
           1);
  return share;
}

}  // namespace

FeatureRegression::FeatureRegression(const Features& features, const HalvedImage& image, const CancelTest& cancel) {
  PixelWeights weights = weigh_pixels(image);
  by_features_ = LocalRegression(basis_of(features), std::move(weights.in_windows), std::move(weights.own), kByFeatures);
  RegressionResult first = by_features_.estimate(image.mean, image.half_difference, cancel);
  const Field by_light = weigh_by_light(first.mean);
  Field residual = difference(image.mean, first.mean), of_noise = difference(image.half_difference, first.noise);
  kept_ = limit_outliers(residual, by_light);
  scale_by(kept_, &residual);
  scale_by(kept_, &of_noise);
  of_residual_ = LocalRegression(albedo_of(features), by_light, Field(residual.width(), residual.height(), 1), kOfResidual);
  const RegressionResult second = of_residual_.estimate(residual, of_noise, cancel);
  image_ = std::move(first.mean);
  add(second.mean, &image_);
  Field noise = std::move(first.noise);
  add(second.noise, &noise);
  error_ = box_mean(make_field(noise.width(), noise.height(), [&](int x, int y) { return mean_of_squares(noise, x, y); }), kLightRadius);
  add(first.bias, &error_);
}

Field FeatureRegression::apply(const Field& values, const CancelTest& cancel) const {
  Field result = by_features_.apply(values, cancel);
  Field residual = difference(values, result);
  scale_by(kept_, &residual);
  add(of_residual_.apply(residual, cancel), &result);
  return result;
}

}  // namespace gradus
