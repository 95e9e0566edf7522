// Light is not negative. Windows that hold the edge of a highlight are planes, which go below 0 on its dark side: black
// pixels on mirrors.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Share of its own sampled value that each pixel takes, so that in no channel less than a quarter is left of what was
// sampled there: of the pixel, or of the median of 3×3 where that is less, since the pixel may be a firefly. One
// channel; 0 for most.
Field restore_sampled_light(const Field& sampled, const Field& regressed);

// The regressed value moves to the sampled one by that share.
void blend_sampled(const Field& share, const Field& sampled, Field* regressed);

}  // namespace gradus::reconstruct
