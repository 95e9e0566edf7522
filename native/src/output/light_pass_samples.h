// What was sampled of the parts of a frame's light, in both halves.
#pragma once

#include <vector>

#include "film/features.h"
#include "reconstruct/halved_image.h"

namespace gradus {

using LightPassPlanes = std::vector<const PassPlane*>;

// Of a plane that is kept in halves, three channels. Where a half has no samples, what differs from the pixels around stands for the noise.
HalvedImage read_light_pass(const Film& film, const PassPlane& plane);
// What of the light is in none of the planes.
HalvedImage read_remainder(const Film& film, const LightPassPlanes& planes);
// Means of a colour pass.
FeatureImage read_color(const Film& film, const PassPlane& plane);

}  // namespace gradus
