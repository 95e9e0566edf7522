// What was sampled of the parts of a frame's light, in both halves.
#pragma once

#include <vector>

#include "film/features.h"
#include "reconstruct/halved_image.h"

namespace gradus::output {

using LightPassPlanes = std::vector<const film::PassPlane*>;

// Of a plane that is kept in halves, three channels. Where a half has no samples, what differs from the pixels around
// stands for the noise.
reconstruct::HalvedImage read_light_pass(const film::Film& film, const film::PassPlane& plane);
// What of the light is in none of the planes.
reconstruct::HalvedImage read_remainder(const film::Film& film, const LightPassPlanes& planes);
// Means of a colour pass.
film::FeatureImage read_color(const film::Film& film, const film::PassPlane& plane);

}  // namespace gradus::output
