// Weights by measured noise over a window, as of a single frame (noise_weights.h).
#pragma once

#include "reconstruct/space_time/system.h"

namespace gradus {

void weigh_by_noise(const WindowSource& source, float scale, SpaceTimeSystem* system);

}  // namespace gradus
