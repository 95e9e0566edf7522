// Protection against black pixels beside highlights. A window that contains the edge of a highlight is fitted by a
// plane, which falls below 0 on the dark side of the edge; this shows as black pixels on mirrors.
#pragma once

#include "reconstruct/field.h"

namespace gradus::reconstruct {

// Returns, per pixel, the share of the sampled value to blend into the regressed value, so that each channel keeps at
// least a quarter of what was sampled: of the pixel's own value, or of the median of 3×3 pixels if that is less,
// because the pixel may be a firefly. One channel; 0 in most pixels.
Field restore_sampled_light(const Field& sampled, const Field& regressed);

// Moves the regressed values to the sampled ones by `share`.
void blend_sampled(const Field& share, const Field& sampled, Field* regressed);

}  // namespace gradus::reconstruct
