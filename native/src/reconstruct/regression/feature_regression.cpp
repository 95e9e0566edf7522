#include "reconstruct/regression/feature_regression.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "base/types.h"
#include "reconstruct/box_mean.h"
#include "reconstruct/displaced.h"
#include "reconstruct/field_values.h"
#include "reconstruct/poisson/twicing.h"
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
// Factor on the noise of their difference: where there is only noise, half of its estimates would show a bias.
constexpr float kShareDoubt = 2.0f;
// Side of the blocks that share a bound on outliers.
constexpr int kBlockSide = 16;

// Noise and light of each pixel, and their means around each pixel.
struct Surroundings {
  Field own_noise, own_light, noise, light;
};

Field noise_of(const HalvedImage& image) {
  return make_field(image.mean.width(), image.mean.height(),
                    [&](int x, int y) { return std::sqrt(mean_of_squares(image.half_difference, x, y)); });
}

Surroundings look_around(const HalvedImage& image) {
  Field noise = noise_of(image);
  Field light = make_field(image.mean.width(), image.mean.height(),
                           [&](int x, int y) { return brightness_of(image.mean, x, y); });
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

// Returns the regressed image where samples lie. `displacement`: of the samples; empty: at the centres of pixels.
Field where_sampled(const Field& regressed, const Field& displacement) {
  return displacement.channels() == 0 ? regressed : displaced(regressed, displacement);
}

// Returns what samples have more than the regressed image where they lie.
Field residual(const Field& sampled, const Field& regressed, const Field& displacement) {
  Field result = where_sampled(regressed, displacement);
  for_values(&result, [&](float& value, int x, int y, int c) { value = sampled.row(y, c)[x] - value; });
  return result;
}

// Returns the share of each residual that lies within the bound on outliers (twicing.h), relative to the light around
// it.
Field limit_outliers(const Field& residual, const Field& by_light) {
  const int w = residual.width(), h = residual.height();
  Field share = make_field(w, h, [&](int x, int y) { return by_light.row(y)[x] * mean_of_squares(residual, x, y); });
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
// the mean of minimum squared error is Wiener's, but for kShareDoubt.
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
    return of_noise > 0.0f ? std::max(1.0f - kShareDoubt * of_noise / of_mean, 0.0f) : 1.0f;
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
// the weights by noise, which suppress outliers. `by_noise` is the fourth root of these.
Field weigh_residual(const Field& by_light, const Field& by_noise) {
  return make_field(by_light.width(), by_light.height(), [&](int x, int y) {
    const float light = std::sqrt(by_light.row(y)[x]);
    return light * std::sqrt(light) * by_noise.row(y)[x];
  });
}

PictureSamples samples_of(Field features, const HalvedImage& image) {
  const int w = image.mean.width(), h = image.mean.height();
  Surroundings surroundings = look_around(image);
  PixelWeights weights = weigh_pixels(surroundings);
  Predictors of_residual{albedo_of(features), make_field(w, h, [&](int x, int y) {
                           return std::sqrt(std::sqrt(weights.in_windows.row(y)[x]));
                         })};
  LightOfSamples light{make_field(w, h, [](int, int) { return 1.0f; }), image.mean,
                       make_field(w, h, [&](int x, int y) { return mean_of_squares(image.half_difference, x, y); })};
  auto in_windows = std::make_shared<const Predictors>(Predictors{std::move(features), std::move(weights.in_windows)});
  return {{std::move(in_windows), std::make_shared<const Field>(std::move(weights.own))},
          std::move(of_residual),
          not_joined(image.mean),
          not_joined(image.half_difference),
          std::move(light),
          std::move(surroundings.noise)};
}

Values first_step(const JoinedPlane& plane) { return {plane.in_windows.get(), plane.own.get()}; }

}  // namespace

float typical_depth(const film::Features& features) {
  const std::vector<float>& depths = features.depth.values;
  std::vector<float> there;
  std::copy_if(depths.begin(), depths.end(), std::back_inserter(there),
               [](float d) { return is_finite(d) && d > 0.0f; });
  return median_or_one(&there);
}

Field regression_features(const film::Features& features, float unit) {
  Field basis(features.width, features.height, kFeatureChannels);
  for_values(&basis, [&](float& value, int x, int y, int c) {
    const int column = GRADUS_FAULT(features_shifted_by_a_column) ? std::min(x + 1, features.width - 1) : x;
    const size_t i = size_t(y) * size_t(features.width) + size_t(column);
    const float sampled = feature_value(features, i, c);
    value = c < kDepth ? bounded(sampled) : relative_depth(sampled, unit);
    if (!is_finite(value)) value = 0.0f;
  });
  return basis;
}

Field regress_coarsely(Predictors predictors, const HalvedImage& image, const CancelCheck& cancel) {
  return LocalRegression({std::make_shared<const Predictors>(std::move(predictors)), nullptr}, kCoarse)
      .estimate({&image.mean, &image.mean}, {&image.half_difference, &image.half_difference}, cancel)
      .mean;
}

PixelWeights weigh_pixels(const HalvedImage& image) { return weigh_pixels(look_around(image)); }

Field noise_around(const HalvedImage& image) { return box_mean(noise_of(image), kNoiseRadius); }

JoinedPlane not_joined(const Field& field) {
  const std::shared_ptr<const Field> same(std::shared_ptr<void>(), &field);
  return {same, same, same};
}

FeatureRegression::FeatureRegression(Field features, const HalvedImage& image, const CancelCheck& cancel,
                                     Field* delivered_error)
    : FeatureRegression(samples_of(std::move(features), image), image, cancel, delivered_error) {}

FeatureRegression::FeatureRegression(PictureSamples samples, const HalvedImage& image, const CancelCheck& cancel,
                                     Field* delivered_error) {
  fine_ = LocalRegression(samples.first_step, kFine);
  RegressionSamples of_windows = samples.first_step;
  of_windows.own_weights = nullptr;
  coarse_ = LocalRegression(std::move(of_windows), kCoarse);
  const Values mean = first_step(samples.mean), half_difference = first_step(samples.half_difference);
  RegressionResult first = fine_.estimate(mean, half_difference, cancel);
  {
    const RegressionResult coarse = coarse_.estimate(mean, half_difference, cancel);
    share_ = share_of_fine(first, coarse);
    blend(share_, coarse.mean, &first.mean);
    blend(share_, coarse.noise, &first.noise);
    blend_bias(share_, coarse.bias, &first.bias);
  }
  add_residual(samples, &first, cancel);
  restored_ = restore_lost_light(first.mean, where_sampled(first.mean, displacement_), samples.noise, samples.light);
  scale_by(restored_, &first.mean);
  scale_by(restored_, &first.noise);
  own_ = restore_sampled_light(image.mean, first.mean);
  blend_sampled(own_, image.mean, &first.mean);
  blend_sampled(own_, image.half_difference, &first.noise);
  const RegressionError error({image.mean, image.half_difference, first.mean, first.noise}, first.bias);
  error_ = error.of(ErrorUse::Weights);
  if (delivered_error != nullptr) *delivered_error = error.of(ErrorUse::Delivered);
  image_ = std::move(first.mean);
}

void FeatureRegression::add_residual(const PictureSamples& samples, RegressionResult* first,
                                     const CancelCheck& cancel) {
  const Field by_light = weigh_by_light(first->mean, kLightRadius);
  const Predictors& given = samples.second_step;
  displacement_ = given.displacement;
  Field mean = residual(*samples.mean.of_residual, first->mean, displacement_);
  Field noise =
      residual(*(GRADUS_FAULT(second_step_takes_image_for_noise) ? samples.mean : samples.half_difference).of_residual,
               first->noise, displacement_);
  residual_share_ = limit_outliers(mean, by_light);
  scale_by(residual_share_, &mean);
  scale_by(residual_share_, &noise);
  const std::shared_ptr<const Field>& estimated = samples.first_step.estimated;
  of_residual_ = LocalRegression(
      {std::make_shared<const Predictors>(Predictors{given.features, weigh_residual(by_light, given.weights)}), nullptr,
       estimated ? std::make_shared<const Field>(albedo_of(*estimated)) : nullptr},
      kOfResidual);
  const RegressionResult second = of_residual_.estimate({&mean, &mean}, {&noise, &noise}, cancel);
  if (!GRADUS_FAULT(second_step_dropped)) add(second.mean, &first->mean);
  if (!GRADUS_FAULT(error_omits_second_step)) add(second.noise, &first->noise);
}

Field FeatureRegression::apply(const JoinedPlane& values, const Field& sampled, const CancelCheck& cancel) const {
  Field result = fine_.apply(first_step(values), cancel);
  if (!GRADUS_FAULT(alpha_lacks_large_windows)) blend(share_, coarse_.apply(first_step(values), cancel), &result);
  Field of_residual = residual(*values.of_residual, result, displacement_);
  if (!GRADUS_FAULT(alpha_keeps_outliers)) scale_by(residual_share_, &of_residual);
  if (!GRADUS_FAULT(second_step_of_other_channels_dropped))
    add(of_residual_.apply({&of_residual, &of_residual}, cancel), &result);
  if (result.channels() == 3) scale_by(restored_, &result);
  blend_sampled(own_, sampled, &result);
  return result;
}

}  // namespace gradus::reconstruct
