// First-order regression in windows. In windows of several sizes around every pixel, the image is modelled as linear in
// the features:
//   a_q = argmin Σ_{p in window} w_p (I_p − a·φ_p)² + λ Σw |a|²     (λ not for the constant)
// A pixel's value is the mean of the predictions of all windows that contain it, weighted by their confidence η:
//   x_p = (Σ_q η_q a_q·φ_p + I_p/v_p) / (Σ_q η_q + 1/v_p),
//   η = 1/(number of windows of that size that contain a pixel · estimated squared error).
// The pixel itself, of variance v_p, is the smallest window: as noise vanishes, the image tends to the sampled one,
// whatever the features. Moon, Carr, Yoon 2014 and Bitterli et al. 2016 (NFOR) regress on features. Here, weights
// belong to pixels and not to pairs of pixels, so that windows are sums (as in the guided filter: He, Sun, Tang 2010),
// and several window sizes replace weights by distance.
//
// Windows begin on a regular lattice and consist of square blocks of pixels. The moments of two adjacent blocks add up
// to those of their union, and the estimates of windows are distributed to their blocks by the adjoint operation. A
// window of any size therefore costs a few additions and one solve.
//
// The error of a window is estimated from the half-buffers, by regressing their mean v and half their difference d with
// the same weights:
//   bias² = (Σ w e_v² − Σ w e_d²)/Σw    noise = Σ w (a_d·φ)²/Σw
// Noise contributes equally to the residuals e_v and e_d; what the features cannot explain is in e_v alone.
#pragma once

#include <memory>
#include <vector>

#include "base/cancel_check.h"
#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Windows of one scale. They begin at every block of `side` × `side` pixels and consist of 4 × 4 such blocks; if
// `small`, there are also windows of 2 × 2 blocks.
struct Octave {
  int side = 2;  // 2 or a multiple of 4
  bool small = false;
};

struct RegressionSettings {
  std::vector<Octave> octaves;  // ascending, each side twice the one before
  int lattices = 1;             // 2: also the same windows shifted by a pixel along both axes
  bool coordinates = false;     // whether the pixel's x and y are features, too
  float ridge = 1e-3f;          // λ, for features that range over about 1
  float floor = 1e-4f;          // minimum of the estimated squared error of a window
};

struct RegressionResult {
  Field mean;  // x, three channels
  // The same operator's result for half the difference of the half-buffers. Its square estimates the variance of x.
  Field noise;
  // Estimated squared bias, mean over the channels, one channel. Where noise hides it, half the values are negative.
  Field bias;
};

// Features that samples are modelled by, and the weight of each pixel.
struct Predictors {
  Field features;  // 7 channels with coordinates, or 3 without, in about [−1, 1]
  Field weights;   // one channel, 0 where a pixel does not count
  // Where the samples of a pixel lie, relative to its centre, in pixels: x and y first. Empty: at the centre.
  Field displacement{};
};

// Samples by which an image is regressed. If the samples of several frames are joined, those in windows and pixels' own
// ones are means with different weights.
struct RegressionSamples {
  std::shared_ptr<const Predictors> in_windows;
  std::shared_ptr<const Field> own_weights{};  // 1/v; null if pixels are no windows of their own
  std::shared_ptr<const Field> estimated{};    // features of the pixels to estimate; null: those in windows

  const Field& estimated_features() const { return estimated ? *estimated : in_windows->features; }
};

// An image as it was sampled: by the samples in windows and by pixels' own ones. Both are the same for a single frame.
struct Values {
  const Field *in_windows, *own;
};

class LocalRegression {
 public:
  LocalRegression() = default;
  LocalRegression(RegressionSamples samples, RegressionSettings settings);

  // Regresses three channels, estimates η from half the difference of the half-buffers, and freezes it. Deterministic
  // for any number of threads.
  RegressionResult estimate(const Values& mean, const Values& half_difference, const CancelCheck& cancel);
  // Applies the frozen operator to one or three channels.
  Field apply(const Values& values, const CancelCheck& cancel) const;

 private:
  RegressionSamples samples_;
  RegressionSettings settings_;
  std::vector<Field> confidence_;  // η of the windows of each octave, for one lattice after another
};

}  // namespace gradus::reconstruct
