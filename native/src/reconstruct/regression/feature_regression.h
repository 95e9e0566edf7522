// Regression of an image on its features: in small windows, and in large ones where these are as good. A second
// regression, of the residual, then restores what the first one lost. All steps are linear in the image once their
// weights are known, so other planes can go through them.
#pragma once

#include "film/features.h"
#include "reconstruct/regression/halved_image.h"
#include "reconstruct/regression/local_regression.h"

namespace gradus::reconstruct {

// Side in pixels of a grid at whose lines blocks of all windows begin: a multiple of every Octave::side. A region that
// begins on the grid has the windows of the full frame.
inline constexpr int kRegressionGrid = 16;

// Features by which an image is modelled.
struct ImageFeatures {
  Field sampled;  // of the light that was sampled in each pixel, as regression_features() returns them
  // If the light of a pixel was sampled at several places: their mean displacement from its centre, x and y in pixels,
  // and the features at the centre. Otherwise empty.
  Field displacement{}, centre{};
};

// Returns normal, albedo, and d/(d + unit) of the depth d: seven channels. `unit` is the typical depth.
Field regression_features(const film::Features& features, float unit);
// Returns the median of the finite, positive depths; 1 if there are none.
float median_depth(const film::Features& features);
// Returns the weights of pixels in windows. `image` is in units of its median luminance.
Field weights_in_windows(const HalvedImage& image);

class FeatureRegression {
 public:
  // Regresses `image` on `features` and freezes the weights of all steps. `delivered_error`, unless it is nullptr,
  // receives the error of the pass Error.
  FeatureRegression(ImageFeatures features, const HalvedImage& image, const CancelCheck& cancel,
                    Field* delivered_error = nullptr);
  FeatureRegression(const film::Features& features, const HalvedImage& image, const CancelCheck& cancel,
                    Field* delivered_error = nullptr);

  const Field& image() const { return image_; }
  // Returns the estimated squared error of the image, mean over its channels, bias included, which weighs pixels.
  const Field& error() const { return error_; }
  // Applies the frozen operator to one or three channels.
  Field apply(const Field& values, const CancelCheck& cancel) const;

 private:
  // Adds the regression of the residual to the mean and the noise of `first`.
  void add_residual(const HalvedImage& image, const Predictors& of_image, RegressionResult* first,
                    const CancelCheck& cancel);

  LocalRegression fine_, coarse_, of_residual_;
  Field share_;           // share of the small windows in each pixel
  Field residual_share_;  // share of each pixel's residual that is restored: outliers are limited
  // Share of each pixel's own sampled value in the result (restore_sampled_light.h). Empty for changes of light.
  Field own_;
  Field image_, error_;
};

}  // namespace gradus::reconstruct
