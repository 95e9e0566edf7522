// Weights of L2: α² for pixels and 1 for all differences that exist (T-GPT eq. 3).
#pragma once

#include "reconstruct/space_time/system.h"

namespace gradus::reconstruct {

// Sets the weights. A row exists if its value is finite in all channels. L2 is unbiased if the samples do not decide
// which rows exist.
void weigh_uniformly(const WindowSource& source, float alpha, SpaceTimeSystem* system);

}  // namespace gradus::reconstruct
