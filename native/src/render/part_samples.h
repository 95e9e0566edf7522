// What was sampled of the parts of a frame's light, in both halves.
#pragma once

#include <vector>

#include "frame/features.h"
#include "reconstruct/halved_image.h"

namespace gradus {

using PartPlanes = std::vector<const PassPlane*>;

// Of a plane that is kept in halves, three channels. Where a half has no samples, what differs from the pixels around stands for the noise.
HalvedImage read_part(const Frame& frame, const PassPlane& plane);
// What of the light is in none of the planes.
HalvedImage read_rest(const Frame& frame, const PartPlanes& planes);
// Means of a colour pass.
FeatureImage read_color(const Frame& frame, const PassPlane& plane);

}  // namespace gradus
