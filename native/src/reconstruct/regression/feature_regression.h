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

// Samples of another frame, whose pixels were moved to where the image shows the same surfaces. All values are 0 in
// pixels to which none was moved.
struct MovedFrame {
  Field features;      // as regression_features() returns them
  HalvedImage image;   // in the units of the image that is regressed
  Field deviation;     // standard deviation around each pixel, from deviation_in_windows()
  Field own;           // weight of each pixel's own value
  Field kept;          // share of the weight of each pixel, 0 to 1
  Field displacement;  // of the samples from the centre of their pixel, x and y in pixels
};

// Returns the features of the regression: normal, albedo, and d/(d + unit) of the depth d.
Field regression_features(const film::Features& features, float unit);
// Returns the median of the finite, positive depths; 1 if there are none.
float median_depth(const film::Features& features);
// Returns the standard deviation by which pixels count in windows, from `image` in units of its median luminance.
Field deviation_in_windows(const HalvedImage& image);
// Returns the weight 1/variance of each pixel's own value.
Field own_weights(const HalvedImage& image);

class FeatureRegression {
 public:
  // Regresses `image` on `features` and freezes the weights of all steps. `delivered_error`, unless it is nullptr,
  // receives the error of the pass Error. The samples of `others` contribute to the same windows.
  FeatureRegression(const film::Features& features, const HalvedImage& image, const CancelCheck& cancel,
                    Field* delivered_error = nullptr, const std::vector<MovedFrame>& others = {},
                    std::shared_ptr<const Field> estimated = {});

  const Field& image() const { return image_; }
  // Returns the estimated squared error of the image, mean over its channels, bias included, which weighs pixels.
  const Field& error() const { return error_; }
  // Applies the frozen operator to one or three channels: those of the image, then those of each other frame.
  Field apply(const Images& values, const CancelCheck& cancel) const;
  Field apply(const Field& values, const CancelCheck& cancel) const { return apply(Images{&values}, cancel); }

 private:
  // Adds the regression of the residual to the mean and the noise of `first`.
  void add_residual(const film::Features& features, const HalvedImage& image, const std::vector<MovedFrame>& others,
                    const Layers& layers, RegressionResult* first, const CancelCheck& cancel);

  LocalRegression fine_, coarse_, of_residual_;
  Field share_;           // share of the small windows in each pixel
  // Share of each pixel's residual that is restored, for each layer: outliers are limited, and pixels that hold no
  // samples have no residual.
  std::vector<Field> residual_share_;
  // Share of each pixel's own sampled value in the result (restore_sampled_light.h). Empty for changes of light.
  Field own_;
  Field image_, error_;
};

}  // namespace gradus::reconstruct
