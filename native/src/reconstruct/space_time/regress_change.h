// How the light of pixels changes along their links from a frame to the next: what was sampled of it, by regression on features. Where
// nothing changes it is exactly 0.
#pragma once

#include "frame/features.h"
#include "reconstruct/solver.h"
#include "reconstruct/space_time/links.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus {

struct Change {
  Links links;
  Field difference;  // channels of the source; of pixels without a link any number
  Field weight;      // 1/(its estimated squared error)
};

// From frame t on. features: that frame's, filtered; scale: its median luminance.
Change regress_change(const HalvedWindowSource& source, int t, const Features& features, float scale, const CancelTest& cancel);

}  // namespace gradus
