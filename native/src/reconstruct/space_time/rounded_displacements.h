// Correction of displacements that are rounded to whole pixels: the change of an image by the remaining fraction of a
// pixel.
#pragma once

#include "reconstruct/field.h"
#include "reconstruct/space_time/correspondence_map.h"
#include "reconstruct/space_time/window_source.h"

namespace gradus::reconstruct {

// Returns the change of frame t's image along the correspondences if it only moved with its film displacements, because
// these end beside the centres of the corresponding pixels. 0 without a correspondence and where all displacements end
// at the centres.
Field rounding_change(const Field& picture, const CorrespondenceMap& correspondence, const HalvedWindowSource& source,
                      int t);

// Scales the change to the share that the sampled change shows around each pixel, by least squares: what a surface
// shows, such as a reflection, need not move with the surface.
void keep_sampled_share(const Field& sampled, Field* rounding);

}  // namespace gradus::reconstruct
