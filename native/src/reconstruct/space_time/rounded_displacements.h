// What is left of ways when links take them to whole pixels: by less than a pixel, and otherwise from pixel to pixel.
#pragma once

#include "reconstruct/field.h"
#include "reconstruct/space_time/correspondence_map.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

// By how much frame t's picture would change along the links if it did nothing but follow its ways to frame t + 1, for
// these end beside the middles of the pixels that are linked. 0 without a link, and where all ways end in the middle.
Field rounding_change(const Field& picture, const CorrespondenceMap& correspondence, const HalvedWindowSource& source,
                      int t);

// Takes as much of it as the sampled change shows around each pixel, by least squares: what a surface shows need not go
// with the surface.
void keep_sampled_share(const Field& sampled, Field* rounding);

}  // namespace gradus::reconstruct
