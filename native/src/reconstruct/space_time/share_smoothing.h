// Smooths values v along every pixel's track, as shares s of the light l around it, so that values fade with the light:
//   v → l s,   s = argmin Σ α² (v − l s)²/l + Σ c (s(φ(i), t+1) − s(i, t))²,
// where c is the smaller of the two lights, times the square of the ratio by which a channel changes most: when a light
// is switched off or changes colour, the shares change. The operation is linear and preserves sums along tracks.
#pragma once

#include "reconstruct/space_time/system.h"

namespace gradus::reconstruct {

class ShareSmoothing {
 public:
  // Adds a frame: its light, by channels, and the pixel correspondences from the frame before it, which are not read
  // for the first frame.
  void add_frame(Field light, const CorrespondenceMap* correspondence);
  // Replaces the values v of all frames that were added by l s. `data_weight` is α².
  void apply(const SpaceTimeSystem& system, float data_weight, Frames* values) const;

 private:
  Field last_;  // light of the frame that was added last
  std::vector<WeightPlane> lights_, couplings_;
};

}  // namespace gradus::reconstruct
