// Regression of an image on its features: in small windows, and in large ones where these are as good. A second
// regression, of the residual, then restores what the first one lost, and factors restore the light that both lost
// (lost_light.h). All steps are linear in the image once their weights are known, so other planes can go through them.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "film/features.h"
#include "reconstruct/regression/halved_image.h"
#include "reconstruct/regression/local_regression.h"
#include "reconstruct/regression/lost_light.h"

namespace gradus::reconstruct {

// Side in pixels of a grid at whose lines blocks of all windows begin: a multiple of every Octave::side. A region that
// begins on the grid has the windows of the full frame.
inline constexpr int kRegressionGrid = 16;

// A plane of a picture's samples. If frames are joined, it was joined three times, with the weights of samples in
// windows, of pixels' own samples, and of samples in the windows of the residual. Otherwise all three are the same.
struct JoinedPlane {
  std::shared_ptr<const Field> in_windows, own, of_residual;
};
// Returns the plane of a single frame. `field` must outlive it.
JoinedPlane not_joined(const Field& field);
JoinedPlane not_joined(const Field&& field) = delete;

// What the regression of a picture reads: the samples of its frame, or those of several frames, joined.
struct PictureSamples {
  RegressionSamples first_step;
  // The samples in the windows of the residual: their albedo, their displacements (displaced.h), and as weights the
  // sums of the fourth roots of their weights in the first step.
  Predictors second_step;
  JoinedPlane mean, half_difference;  // in the units of the picture
  LightOfSamples light;
  Field noise;  // mean noise around each pixel of the picture's own frame
};

// Channels of the features of a regression: normal, albedo and depth.
inline constexpr int kAlbedo = 3, kDepth = 6, kFeatureChannels = 7;
// Returns a channel of a pixel's features as they are.
inline float feature_value(const film::Features& features, size_t pixel, int channel) {
  return channel < kAlbedo  ? features.normal.values[3 * pixel + size_t(channel)]
         : channel < kDepth ? features.albedo.values[3 * pixel + size_t(channel - kAlbedo)]
                            : features.depth.values[pixel];
}
// Returns normal, albedo, and d/(d + unit) of the depth d.
Field regression_features(const film::Features& features, float unit);
// Returns the typical depth: the median of the finite, positive ones; 1 if there are none.
float typical_depth(const film::Features& features);
inline float relative_depth(float depth, float unit) {
  return depth > 0.0f ? std::clamp(depth / (depth + unit), -1.0f, 1.0f) : 0.0f;
}

// Returns a regression of three channels in large windows alone, at a third of the cost.
Field regress_coarsely(Predictors predictors, const HalvedImage& image, const CancelCheck& cancel);

// Weights of the pixels of an image in windows, and of their own values.
struct PixelWeights {
  Field in_windows, own;
};
// `image` is in units of its median luminance.
PixelWeights weigh_pixels(const HalvedImage& image);
// Returns the mean standard deviation of the samples around each pixel.
Field noise_around(const HalvedImage& image);

class FeatureRegression {
 public:
  // Regresses `image` on `features` and freezes the weights of all steps. `delivered_error`, unless it is nullptr,
  // receives the error of the pass Error.
  FeatureRegression(Field features, const HalvedImage& image, const CancelCheck& cancel,
                    Field* delivered_error = nullptr);
  // Regresses the samples of several frames. `image` is that of the picture's own frame.
  FeatureRegression(PictureSamples samples, const HalvedImage& image, const CancelCheck& cancel,
                    Field* delivered_error = nullptr);
  FeatureRegression(const film::Features& features, const HalvedImage& image, const CancelCheck& cancel)
      : FeatureRegression(regression_features(features, typical_depth(features)), image, cancel) {}

  const Field& image() const { return image_; }
  // Returns the estimated squared error of the image, mean over its channels, bias included, which weighs pixels.
  const Field& error() const { return error_; }
  // Applies the frozen operator to one or three channels. `sampled` are those of the picture's own frame.
  Field apply(const JoinedPlane& values, const Field& sampled, const CancelCheck& cancel) const;
  Field apply(const Field& values, const CancelCheck& cancel) const {
    return apply(not_joined(values), values, cancel);
  }

 private:
  // Adds the regression of the residual to the mean and the noise of `first`.
  void add_residual(const PictureSamples& samples, RegressionResult* first, const CancelCheck& cancel);

  LocalRegression fine_, coarse_, of_residual_;
  Field displacement_;    // of the samples of the residual's regression; empty: none
  Field share_;           // share of the small windows in each pixel
  Field residual_share_;  // share of each pixel's residual that is restored: outliers are limited
  Field restored_;        // factors that restore lost light, three channels (lost_light.h)
  // Share of each pixel's own sampled value in the result (restore_sampled_light.h).
  Field own_;
  Field image_, error_;
};

}  // namespace gradus::reconstruct
