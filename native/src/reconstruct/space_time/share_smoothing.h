// Smooths along every pixel's track as shares s of the light l around it, so that what fades with a light goes out with
// it:
//   v → l s,   s = argmin Σ α² (v − l s)²/l + Σ c (s(φ(i), t+1) − s(i, t))²,
// c the lesser of the two lights, times the square of the ratio by which a channel changes most: of a light that goes
// off, or is another's colour, the shares are others. Linear, and sums along tracks stay.
#pragma once

#include "reconstruct/space_time/system.h"

namespace gradus::reconstruct {

class ShareSmoothing {
 public:
  // The next frame's light, by channels, and the links that lead to it; those of the first frame are not read.
  void add_frame(Field light, const CorrespondenceMap* correspondence);
  void apply(const SpaceTimeSystem& system, float data_weight, Frames* values) const;

 private:
  Field last_;  // light of the last frame
  std::vector<WeightPlane> lights_, couplings_;
};

}  // namespace gradus::reconstruct
