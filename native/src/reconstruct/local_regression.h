// First-order regression in windows. Around every pixel, in windows of several sizes, the image is taken to be linear
// in the features:
//   a_q = argmin Σ_{p in window} w_p (I_p − a·φ_p)² + λ Σw |a|²     (λ not for the constant)
// and a pixel's value is the mean of what all windows that hold it say, those with little error first:
//   x_p = (Σ_q η_q a_q·φ_p + I_p/v_p) / (Σ_q η_q + 1/v_p),     η = 1/(windows of that size that hold a pixel ·
//   estimated squared error).
// The pixel itself, of variance v_p, is the smallest window: as noise vanishes the image becomes what was sampled,
// features or not. Moon, Carr, Yoon 2014 and Bitterli et al. 2016 (NFOR) regress on features; here weights belong to
// pixels, not to pairs of them, so that windows are sums (as of the guided filter: He, Sun, Tang 2010), and several
// sizes take the place of weights by distance.
//
// Windows begin on a lattice. They are made of squares of pixels, the sums of two squares side by side are those of
// both, and what windows say goes back to their squares in the same way: a window of any size costs some additions and
// its solve.
//
// The error of a window comes from the half-buffers: of the mean v and half the difference d of the two halves, with
// the same weights,
//   bias² = (Σ w e_v² − Σ w e_d²)/Σw    noise = Σ w (a_d·φ)²/Σw
// since noise leaves as much in the residuals e_v as in e_d, and what the features cannot explain is in e_v alone.
#pragma once

#include <memory>
#include <vector>

#include "reconstruct/field.h"
#include "reconstruct/solver.h"

namespace gradus::reconstruct {

// Windows of one step: they begin at every square of `side` pixels, and are of 4 × 4 such squares; of 2 × 2 besides.
struct Octave {
  int side = 2;  // 2 or a multiple of 4
  bool small = false;
};

struct RegressionSettings {
  std::vector<Octave> octaves;  // ascending, each side twice the one before
  int lattices = 1;             // 2: the same windows a pixel up and to the right, too
  bool coordinates = false;     // the pixel's x and y are features, too
  float ridge = 1e-3f;          // λ, for features that range over about 1
  float floor = 1e-4f;          // squared error that no window is believed to stay below
};

struct RegressionResult {
  Field mean;   // x, three channels
  Field noise;  // what the same operator makes of half the difference of the halves: its square estimates the variance
                // of x
  Field bias;  // estimated squared bias, mean over the channels; one channel; where noise hides it, as often below 0 as
               // above
};

// What the image is taken to follow, and by how much each pixel counts: several regressions can share it.
struct Predictors {
  Field features;  // 7 channels with coordinates, or 3 without, in about [−1, 1]
  Field weights;   // one channel, 0 where a pixel does not count
};

class LocalRegression {
 public:
  LocalRegression() = default;
  // own: 1/v, one channel; none: pixels are not windows of their own.
  LocalRegression(std::shared_ptr<const Predictors> predictors, Field own, RegressionSettings settings);

  // Regresses three channels, given half the difference of the halves, and freezes η. Deterministic for any number of
  // threads.
  RegressionResult estimate(const Field& mean, const Field& half_difference, const CancelCheck& cancel);
  // One channel, or three, by the frozen operator.
  Field apply(const Field& values, const CancelCheck& cancel) const;

 private:
  std::shared_ptr<const Predictors> predictors_;
  Field own_;
  RegressionSettings settings_;
  std::vector<Field> confidence_;  // η of each octave's windows, lattice by lattice
};

}  // namespace gradus::reconstruct
