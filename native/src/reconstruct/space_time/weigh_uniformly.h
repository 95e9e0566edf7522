// Weights of L2: α² of pixels and 1 of all differences that are there (T-GPT eq. 3).
#pragma once

#include "reconstruct/space_time/system.h"

namespace gradus::reconstruct {

// A row is there if its value is, in all channels. Which are there must not depend on the samples; then L2 is unbiased.
void weigh_uniformly(const WindowSource& source, float alpha, SpaceTimeSystem* system);

}  // namespace gradus::reconstruct
