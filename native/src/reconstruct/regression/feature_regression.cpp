#include "reconstruct/regression/feature_regression.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/displaced.h"
#include "reconstruct/field_values.h"
#include "reconstruct/poisson/twicing.h"
#include "reconstruct/regression/lost_light.h"
#include "reconstruct/regression/regression_error.h"
#include "reconstruct/regression/restore_sampled_light.h"
#include "reconstruct/solver_planes.h"

namespace gradus::reconstruct {
namespace {

// The values below were chosen by measurement: docs/method.md, "Regression on features".
constexpr int kFineSide = 2, kMiddleSide = 4, kCoarseSide = 8;  // blocks in pixels
static_assert(kRegressionGrid % kFineSide == 0 && kRegressionGrid % kMiddleSide == 0 &&
              kRegressionGrid % kCoarseSide == 0);

const RegressionSettings kFine{.octaves = {{.side = kFineSide, .small = true}},
                               .lattices = 2,
                               .coordinates = true,
                               .ridge = 3e-4f,
                               .floor = 1e-6f};
const RegressionSettings kCoarse{
    .octaves = {{.side = kMiddleSide}, {.side = kCoarseSide}}, .coordinates = true, .ridge = 3e-4f, .floor = 1e-6f};
const RegressionSettings kOfResidual{
    .octaves = {{.side = kCoarseSide}}, .coordinates = false, .ridge = 1e-3f, .floor = 1e-6f};
// The noise of a pixel is the mean of a window of this radius, unless kOwnShare times the pixel's own noise is larger,
// as for a firefly.
constexpr int kNoiseRadius = 7;
constexpr float kOwnShare = 0.3f;
// Minimum of the noise: a share of the light around the pixel, and a share of the image's median luminance.
constexpr float kShareOfLight = 0.02f, kShareOfMedian = 0.01f;
// A pixel's own value gets the weight of the noise around it, times kOwnTrust, because the mean of windows is better
// than its single values. The weight is less for a pixel that stands out. It is also less where noise exceeds the share
// kVisible of the light: there both half-buffers may have met the same firefly, if the pixel is not darker than those
// around it. kMinVariance is the variance of a pixel that shows none.
constexpr float kOwnTrust = 0.3f, kVisible = 0.1f, kMinVariance = 1e-10f;
// Noise is in proportion to the square root of the light, as for photons, down to this share of the noise around: below
// it, a pixel may be dark by chance.
constexpr float kDarkByChance = 0.5f;
// Radius of the mean light relative to which residuals are measured.
constexpr int kLightRadius = 3;
// Radius within which small and large windows are compared, and radius of the light relative to which they are.
constexpr int kShareRadius = 4, kShareLightRadius = 2;
// Side of the blocks that share a bound on outliers.
constexpr int kBlockSide = 16;

// Noise and light of each pixel, and their means around each pixel.
struct Surroundings {
  Field own_noise, own_light, noise, light;
};

Surroundings look_around(const HalvedImage& image) {
  const int w = image.mean.width(), h = image.mean.height();
  Field noise = make_field(w, h, [&](int x, int y) { return std::sqrt(mean_of_squares(image.half_difference, x, y)); });
  Field light = make_field(w, h, [&](int x, int y) { return std::fabs(mean_of(image.mean, x, y)); });
  return {noise, light, box_mean(noise, kNoiseRadius), box_mean(light, kNoiseRadius)};
}

Field weigh_in_windows(const Surroundings& of) {
  return make_field(of.noise.width(), of.noise.height(), [&](int x, int y) {
    const float around = of.noise.row(y)[x] + kShareOfLight * of.light.row(y)[x];
    const float deviation = std::max(around, kOwnShare * of.own_noise.row(y)[x]) + kShareOfMedian;
    return 1.0f / (deviation * deviation);
  });
}

// Returns the noise that is to be expected of each pixel from its light, at most the noise around it. The ratio of
// noise to the root of the light is averaged, not noise and light separately: a light source, which has light and no
// noise, says nothing about the wall beside it.
Field expected_noise(const Surroundings& of) {
  const auto root = [&](int x, int y) {
    return std::sqrt(std::max(of.own_light.row(y)[x], kDarkByChance * of.noise.row(y)[x]));
  };
  const Field relative = box_mean(make_field(of.noise.width(), of.noise.height(),
                                             [&](int x, int y) {
                                               const float noise = of.own_noise.row(y)[x];
                                               return noise > 0.0f ? noise / root(x, y) : 0.0f;
                                             }),
                                  kNoiseRadius);
  return make_field(of.noise.width(), of.noise.height(),
                    [&](int x, int y) { return std::min(of.noise.row(y)[x], relative.row(y)[x] * root(x, y)); });
}

// Returns the weight 1/variance of a pixel's own value. `excess` is its noise over that around it. `firefly` says how
// probable it is that both half-buffers met the same firefly; at 1 that is as likely as not.
float weigh_pixel(float expected, float excess, float firefly) {
  const float doubt = excess * excess * (1.0f + firefly * firefly);
  const float factor = GRADUS_FAULT(pixel_variance_times_4) ? 4.0f : GRADUS_FAULT(pixel_variance_over_4) ? 0.25f : 1.0f;
  return kOwnTrust / (factor * expected * expected * doubt * doubt + kMinVariance);
}

// Returns the weights of all pixels' own values.
Field weigh_pixel(const Surroundings& of) {
  const Field expected = expected_noise(of);
  return make_field(of.noise.width(), of.noise.height(), [&](int x, int y) {
    const float noise = of.noise.row(y)[x], unit = 1.0f / (of.light.row(y)[x] + kMinVariance);
    const float excess = noise > 0.0f ? std::max(1.0f, of.own_noise.row(y)[x] / noise) : 1.0f;
    const float brightness = std::min(1.0f, of.own_light.row(y)[x] * unit);
    return weigh_pixel(expected.row(y)[x], excess, brightness * noise * unit / kVisible);
  });
}

PixelWeights weigh_pixels(const Surroundings& of) { return {weigh_in_windows(of), weigh_pixel(of)}; }

float bounded(float value) { return is_finite(value) ? std::clamp(value, -1.0f, 1.0f) : 0.0f; }

// First channel of the albedo among the features.
constexpr int kAlbedo = 3;

Field albedo_of(const Field& features) {
  Field albedo(features.width(), features.height(), 3);
  for_values(&albedo, [&](float& value, int x, int y, int c) {
    value = features.row(y, kAlbedo + c)[GRADUS_FAULT(second_step_albedo_shifted) ? std::max(x - 1, 0) : x];
  });
  return albedo;
}

// Returns 1/light² around each pixel, so that residuals count relative to the light.
Field weigh_by_light(const Field& image, int radius) {
  Field light = squared_light(image, radius);
  for_values(&light, [](float& value, int, int, int) { value = 1.0f / value; });
  return light;
}

Field difference(const Field& a, const Field& b) {
  Field result = a;
  for_values(&result, [&](float& value, int x, int y, int c) { value -= b.row(y, c)[x]; });
  return result;
}

// Returns the share of each residual that lies within the bound on outliers (twicing.h), relative to the light around
// it; 0 in pixels without samples, which do not count for the bound.
Field limit_outliers(const Field& residual, const Field& by_light, const Field& weights) {
  const int w = residual.width(), h = residual.height();
  Field share = make_field(w, h, [&](int x, int y) {
    return weights.row(y)[x] > 0.0f ? by_light.row(y)[x] * mean_of_squares(residual, x, y) : NAN;
  });
  for_rows((h + kBlockSide - 1) / kBlockSide,
           [&](int j) {
             for (int i = 0; i < (w + kBlockSide - 1) / kBlockSide; ++i) {
               limit_block(i * kBlockSide, std::min(w, (i + 1) * kBlockSide), j * kBlockSide,
                           std::min(h, (j + 1) * kBlockSide), &share);
             }
           },
           1);
  return share;
}

// Returns the share of small windows in their mean with large ones. The bias of the large windows is their difference
// from the small ones, minus the part of it that noise explains. Almost all of that noise is in the small windows, so
// the mean of minimum squared error is Wiener's.
Field share_of_fine(const RegressionResult& fine, const RegressionResult& coarse) {
  const int w = fine.mean.width(), h = fine.mean.height();
  const Field by_light = weigh_by_light(fine.mean, kShareLightRadius);
  Field differences(w, h, 2);
  for_values(&differences, [&](float& value, int x, int y, int c) {
    const Field &a = c == 0 ? fine.mean : fine.noise, &b = c == 0 ? coarse.mean : coarse.noise;
    for (int i = 0; i < 3; ++i) value += (a.row(y, i)[x] - b.row(y, i)[x]) * (a.row(y, i)[x] - b.row(y, i)[x]);
    value *= by_light.row(y)[x];
  });
  differences = box_mean(differences, kShareRadius);
  return make_field(w, h, [&](int x, int y) {
    const float of_mean = differences.row(y, 0)[x], of_noise = differences.row(y, 1)[x];
    return of_noise > 0.0f ? std::max(1.0f - of_noise / of_mean, 0.0f) : 1.0f;
  });
}

// Replaces a by share · a + (1 − share) · b.
void blend(const Field& share, const Field& b, Field* a) {
  for_values(a, [&](float& value, int x, int y, int c) {
    value = b.row(y, c)[x] + share.row(y)[x] * (value - b.row(y, c)[x]);
  });
}

// Blends squared biases. Large windows have the bias of the small ones and an additional one.
void blend_bias(const Field& share, const Field& coarse, Field* fine) {
  for_values(fine, [&](float& value, int x, int y, int) {
    const float of_coarse = 1.0f - share.row(y)[x], more = std::max(coarse.row(y)[x] - value, 0.0f);
    value = std::min(value, coarse.row(y)[x]) + of_coarse * of_coarse * more;
  });
}

// Returns the weights of the residual's regression: weights by light, which preserve the mean, with some influence of
// the weights by noise, which suppress outliers.
Field weigh_residual(const Field& by_light, const Field& by_noise) {
  return make_field(by_light.width(), by_light.height(), [&](int x, int y) {
    const float light = std::sqrt(by_light.row(y)[x]), noise = std::sqrt(by_noise.row(y)[x]);
    return light * std::sqrt(light * noise);
  });
}

// Returns kept^¾: weights of residuals hold the quarter power of weights by noise, and with it that of the share that
// the test of light keeps.
Field rest_of_share(const Field& kept) {
  return make_field(kept.width(), kept.height(),
                    [&](int x, int y) { return std::sqrt(kept.row(y)[x] * std::sqrt(kept.row(y)[x])); });
}

}  // namespace

float typical_depth(const film::Features& features) {
  const std::vector<float>& depths = features.depth.values;
  std::vector<float> there;
  std::copy_if(depths.begin(), depths.end(), std::back_inserter(there),
               [](float d) { return is_finite(d) && d > 0.0f; });
  return median_or_one(&there);
}

Field regression_features(const film::Features& features, float unit) {
  Field basis(features.width, features.height, 7);
  for_values(&basis, [&](float& value, int x, int y, int c) {
    const int column = GRADUS_FAULT(features_shifted_by_a_column) ? std::min(x + 1, features.width - 1) : x;
    const size_t i = size_t(y) * size_t(features.width) + size_t(column);
    value = c < kAlbedo ? bounded(features.normal.values[3 * i + size_t(c)])
            : c < 6     ? bounded(features.albedo.values[3 * i + size_t(c - kAlbedo)])
                        : relative_depth(features.depth.values[i], unit);
    if (!is_finite(value)) value = 0.0f;
  });
  return basis;
}

Field regress_coarsely(const Predictors& predictors, const HalvedImage& image, const CancelCheck& cancel) {
  return LocalRegression({std::make_shared<const Predictors>(predictors)}, {}, kCoarse)
      .estimate({&image.mean}, {&image.half_difference}, cancel)
      .mean;
}

PixelWeights weigh_pixels(const HalvedImage& image) { return weigh_pixels(look_around(image)); }

FeatureRegression::FeatureRegression(ImageFeatures features, const HalvedImage& image,
                                     const std::vector<MovedFrame>& others, const CancelCheck& cancel,
                                     Field* delivered_error) {
  const Surroundings surroundings = look_around(image);
  PixelWeights weights = weigh_pixels(surroundings);
  layers_ = {
      std::make_shared<const Predictors>(Predictors{std::move(features.sampled), std::move(weights.in_windows)})};
  std::vector<Field> own;
  own.push_back(std::move(weights.own));
  std::vector<Field> kept(1);
  Images means{&image.mean}, half_differences{&image.half_difference};
  for (const MovedFrame& other : others) {
    layers_.push_back(other.predictors);
    own.push_back(other.own);
    kept.push_back(other.kept);
    means.push_back(&other.image.mean);
    half_differences.push_back(GRADUS_FAULT(moved_halves_dropped) ? &image.half_difference
                                                                  : &other.image.half_difference);
  }
  fine_ = LocalRegression(layers_, std::move(own), kFine, features.estimated);
  coarse_ = LocalRegression(layers_, {}, kCoarse, features.estimated);
  RegressionResult first = fine_.estimate(means, half_differences, cancel);
  {
    const RegressionResult coarse = coarse_.estimate(means, half_differences, cancel);
    share_ = share_of_fine(first, coarse);
    blend(share_, coarse.mean, &first.mean);
    blend(share_, coarse.noise, &first.noise);
    blend_bias(share_, coarse.bias, &first.bias);
  }
  add_residual(image, features.estimated.get(), others, &first, cancel);
  std::vector<Field> residuals;
  for (size_t i = 0; i < means.size(); ++i) residuals.push_back(residual(i, *means[i], first.mean));
  restored_ = restore_lost_light(first.mean, surroundings.noise, kept, residuals, half_differences);
  scale_by(restored_, &first.mean);
  scale_by(restored_, &first.noise);
  own_ = restore_sampled_light(image.mean, first.mean);
  blend_sampled(own_, image.mean, &first.mean);
  blend_sampled(own_, image.half_difference, &first.noise);
  const Smoothed smoothed{image.mean, image.half_difference, first.mean, first.noise};
  error_ = regression_error(smoothed, first.bias, ErrorUse::Weights);
  if (delivered_error != nullptr) *delivered_error = regression_error(smoothed, first.bias, ErrorUse::Delivered);
  image_ = std::move(first.mean);
}

void FeatureRegression::add_residual(const HalvedImage& image, const Field* estimated,
                                     const std::vector<MovedFrame>& others, RegressionResult* first,
                                     const CancelCheck& cancel) {
  const Field by_light = weigh_by_light(first->mean, kLightRadius);
  Layers predictors;
  std::vector<Field> residuals, noises;
  for (size_t i = 0; i <= others.size(); ++i) {
    const HalvedImage& sampled = i == 0 ? image : others[i - 1].image;
    residuals.push_back(residual(i, sampled.mean, first->mean));
    noises.push_back(residual(
        i, GRADUS_FAULT(second_step_takes_image_for_noise) ? sampled.mean : sampled.half_difference, first->noise));
    residual_share_.push_back(limit_outliers(residuals[i], by_light, layers_[i]->weights));
    Field weights = weigh_residual(by_light, layers_[i]->weights);
    if (i > 0) scale_by(rest_of_share(others[i - 1].kept), &weights);
    predictors.push_back(
        std::make_shared<const Predictors>(Predictors{albedo_of(layers_[i]->features), std::move(weights)}));
    scale_by(residual_share_[i], &residuals[i]);
    scale_by(residual_share_[i], &noises[i]);
  }
  of_residual_ = LocalRegression(std::move(predictors), {}, kOfResidual,
                                 estimated ? std::make_shared<const Field>(albedo_of(*estimated)) : nullptr);
  const RegressionResult second = of_residual_.estimate(pointers_to(residuals), pointers_to(noises), cancel);
  if (!GRADUS_FAULT(second_step_dropped)) add(second.mean, &first->mean);
  if (!GRADUS_FAULT(error_omits_second_step)) add(second.noise, &first->noise);
}

Field FeatureRegression::residual(size_t layer, const Field& sampled, const Field& regressed) const {
  const Field& displacement = layers_[layer]->displacement;
  return difference(sampled, displacement.channels() == 0 ? regressed : displaced(regressed, displacement));
}

Field FeatureRegression::apply(const Images& values, const CancelCheck& cancel) const {
  Field result = fine_.apply(values, cancel);
  if (!GRADUS_FAULT(alpha_lacks_large_windows)) blend(share_, coarse_.apply(values, cancel), &result);
  std::vector<Field> residuals;
  for (size_t i = 0; i < values.size(); ++i) {
    residuals.push_back(residual(i, *values[i], result));
    if (!GRADUS_FAULT(alpha_keeps_outliers)) scale_by(residual_share_[i], &residuals[i]);
  }
  if (!GRADUS_FAULT(second_step_of_other_channels_dropped))
    add(of_residual_.apply(pointers_to(residuals), cancel), &result);
  if (result.channels() == 3) scale_by(restored_, &result);
  blend_sampled(own_, *values[0], &result);
  return result;
}

}  // namespace gradus::reconstruct
