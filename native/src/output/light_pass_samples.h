// Reads the samples of the light passes of a film, separately for half-buffers A and B.
#pragma once

#include <vector>

#include "film/features.h"
#include "reconstruct/regression/halved_image.h"

namespace gradus::output {

using LightPassPlanes = std::vector<const film::Channel*>;

// Returns the half-buffers of a light pass with three channels. The plane must be stored in halves. Where a
// half-buffer has no samples, the difference from the surrounding pixels serves as the estimate of the noise.
reconstruct::HalvedImage read_light_pass(const film::Film& film, const film::Channel& plane);
// Returns the half-buffers of the light that none of the given planes contains. `hidden` is the pass with light that
// the planes contain and the picture does not, or null.
reconstruct::HalvedImage read_remainder(const film::Film& film, const LightPassPlanes& planes,
                                        const film::Channel* hidden);
// Returns the mean over the samples of each pixel of a colour pass, 0 where there are no samples.
film::FeatureImage read_color(const film::Film& film, const film::Channel& plane);

}  // namespace gradus::output
