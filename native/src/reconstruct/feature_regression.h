// The image by its features: regression in small windows, and in large ones where these do as well, then what that lost
// is given back by regression of the residual. All steps are linear in the image once their weights are known, so other
// planes can go through them (contract 3.4).
#pragma once

#include "film/features.h"
#include "reconstruct/halved_image.h"
#include "reconstruct/local_regression.h"

namespace gradus::reconstruct {

class FeatureRegression {
 public:
  FeatureRegression(const film::Features& features, const HalvedImage& image, const CancelCheck& cancel);

  const Field& image() const { return image_; }
  // Estimated squared error of the image, mean over its channels, bias included.
  const Field& error() const { return error_; }
  // One channel, or three, by the frozen weights.
  Field apply(const Field& values, const CancelCheck& cancel) const;

 private:
  // The second step: `first` becomes the mean and the noise of both.
  void add_residual(const film::Features& features, const HalvedImage& image, const Field& by_noise,
                    RegressionResult* first, const CancelCheck& cancel);

  LocalRegression fine_, coarse_, of_residual_;
  Field share_;           // of each pixel that the fine windows have
  Field residual_share_;  // share of each pixel's residual that is given back: outliers are limited
  Field own_;  // share of its own sampled value that a pixel has in the end, against black beside highlights; none for
               // changes
  Field image_, error_;
};

}  // namespace gradus::reconstruct
