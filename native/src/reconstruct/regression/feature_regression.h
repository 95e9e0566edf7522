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

namespace gradus::reconstruct {

// Side in pixels of a grid at whose lines blocks of all windows begin: a multiple of every Octave::side. A region that
// begins on the grid has the windows of the full frame.
inline constexpr int kRegressionGrid = 16;

// Samples of another frame, whose pixels were moved to where the image shows the same surfaces. All values are 0 in
// pixels to which none was moved.
struct MovedFrame {
  std::shared_ptr<const Predictors> predictors;
  HalvedImage image;  // in the units of the image that is regressed
  Field own;          // weight of each pixel's own value
  Field kept;         // share of each pixel's weight that the test of light has left
};

// What an image is modelled by.
struct ImageFeatures {
  Field sampled;  // features of the light that was sampled in each pixel, from regression_features()
  // Features for which pixels are estimated. Empty: those of the sampled light.
  std::shared_ptr<const Field> estimated{};
};

// Returns normal, albedo, and d/(d + unit) of the depth d: seven channels.
Field regression_features(const film::Features& features, float unit);
// Returns the typical depth: the median of the finite, positive ones; 1 if there are none.
float typical_depth(const film::Features& features);
inline float relative_depth(float depth, float unit) {
  return depth > 0.0f ? std::clamp(depth / (depth + unit), -1.0f, 1.0f) : 0.0f;
}

// Returns a regression of three channels in large windows alone, at a third of the cost.
Field regress_coarsely(const Predictors& predictors, const HalvedImage& image, const CancelCheck& cancel);

// Weights of the pixels of an image in windows, and of their own values.
struct PixelWeights {
  Field in_windows, own;
};
// `image` is in units of its median luminance.
PixelWeights weigh_pixels(const HalvedImage& image);

class FeatureRegression {
 public:
  // Regresses `image` on `features` and freezes the weights of all steps. The samples of `others` contribute to the
  // same windows. `delivered_error`, unless it is nullptr, receives the error of the pass Error.
  FeatureRegression(ImageFeatures features, const HalvedImage& image, const std::vector<MovedFrame>& others,
                    const CancelCheck& cancel, Field* delivered_error = nullptr);
  FeatureRegression(const film::Features& features, const HalvedImage& image, const CancelCheck& cancel)
      : FeatureRegression({regression_features(features, typical_depth(features))}, image, {}, cancel) {}

  const Field& image() const { return image_; }
  // Returns the estimated squared error of the image, mean over its channels, bias included, which weighs pixels.
  const Field& error() const { return error_; }
  // Applies the frozen operator to one or three channels: those of the image, then those of each other frame.
  Field apply(const Images& values, const CancelCheck& cancel) const;
  Field apply(const Field& values, const CancelCheck& cancel) const { return apply(Images{&values}, cancel); }

 private:
  // Adds the regression of the residual to the mean and the noise of `first`. `estimated`: ImageFeatures::estimated.
  void add_residual(const HalvedImage& image, const Field* estimated, const std::vector<MovedFrame>& others,
                    RegressionResult* first, const CancelCheck& cancel);

  // Returns what the samples of a layer have more than the regressed image where they lie.
  Field residual(size_t layer, const Field& sampled, const Field& regressed) const;

  Layers layers_;
  LocalRegression fine_, coarse_, of_residual_;
  Field share_;  // share of the small windows in each pixel
  // Share of each pixel's residual that is restored, for each layer: outliers are limited, and pixels that hold no
  // samples have no residual.
  std::vector<Field> residual_share_;
  Field restored_;  // factors that restore lost light, three channels (lost_light.h)
  // Share of each pixel's own sampled value in the result (restore_sampled_light.h).
  Field own_;
  Field image_, error_;
};

}  // namespace gradus::reconstruct
