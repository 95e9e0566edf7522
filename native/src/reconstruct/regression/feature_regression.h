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

class FeatureRegression {
 public:
  // Regresses `image` on `features` and freezes the weights of all steps. `delivered_error`, unless it is nullptr,
  // receives the error of the pass Error.
  FeatureRegression(const film::Features& features, const HalvedImage& image, const CancelCheck& cancel,
                    Field* delivered_error = nullptr);

  const Field& image() const { return image_; }
  // Returns the estimated squared error of the image, mean over its channels, bias included, which weighs pixels.
  const Field& error() const { return error_; }
  // Applies the frozen operator to one or three channels.
  Field apply(const Field& values, const CancelCheck& cancel) const;

 private:
  // Adds the regression of the residual to the mean and the noise of `first`.
  void add_residual(const film::Features& features, const HalvedImage& image, const Field& by_noise,
                    RegressionResult* first, const CancelCheck& cancel);

  LocalRegression fine_, coarse_, of_residual_;
  Field share_;           // share of the small windows in each pixel
  Field residual_share_;  // share of each pixel's residual that is restored: outliers are limited
  // Share of each pixel's own sampled value in the result (restore_sampled_light.h). Empty for changes of light.
  Field own_;
  Field image_, error_;
};

}  // namespace gradus::reconstruct
