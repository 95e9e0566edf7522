// Twicing over a window (twicing.h): x = x₀ + S W (I − x₀) restores what an estimate x₀ lost of the noisy images I. S
// smooths in every frame as the L2 solver does, then along the tracks, so that the restored light does not flicker. It
// smooths shares of the light at each pixel, because bright frames have lost more than dark ones. W limits outliers of
// the residual in blocks.
#pragma once

#include "reconstruct/poisson/poisson_dct.h"
#include "reconstruct/space_time/share_smoothing.h"

namespace gradus::reconstruct {

class WindowTwicing {
 public:
  // Estimates W from the first channels of `source`, as many as x₀ (`estimate`) has, and freezes it.
  WindowTwicing(const WindowSource& source, const Frames& estimate, const SpaceTimeSystem& system, float alpha);
  // Replaces x₀ by x for the channels of `planes` from `first_channel` on.
  void apply(const WindowSource& planes, int first_channel, const SpaceTimeSystem& system, Frames* x) const;

 private:
  // Applies the L2 solver in S to one frame. fill(y, row) writes rows of all channels, one after another.
  Field smooth_frame(int channels, const PoissonDct::FillRow& fill) const;

  std::vector<WeightPlane> kept_;  // W; 0 where I is not finite
  PoissonDct dct_;
  float data_weight_;
  ShareSmoothing along_tracks_;
};

}  // namespace gradus::reconstruct
