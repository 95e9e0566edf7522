// Weights for one step of iteratively reweighted least squares over a window, as for a single frame (l1_weights.h).
#pragma once

#include "reconstruct/space_time/system.h"

namespace gradus::reconstruct {

// Sets the weights from the residuals at x. All channels of a pixel have the same weight. For alpha, scale and floor
// see reweight() in l1_weights.h.
void weigh_by_residuals(const WindowSource& source, const Frames& x, float alpha, float scale, float floor,
                        SpaceTimeSystem* system);

}  // namespace gradus::reconstruct
