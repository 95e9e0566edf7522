// (1 + DᵀD/α²)⁻¹ along every pixel's track, D the differences of linked pixels: exact, by elimination from the first frame to the last.
// Sums along tracks stay.
#pragma once

#include "reconstruct/space_time/system.h"

namespace gradus {

void smooth_tracks(const SpaceTimeSystem& system, float data_weight, Frames* values);

}  // namespace gradus
