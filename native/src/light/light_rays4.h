// Four shadow rays towards one light sample.
#pragma once

#include "geometry/rays4.h"
#include "light/light_sampling.h"

namespace gradus::light {

// Returns the segments from four surface points to a light sample; see ray_to_light(). `direction` and `distance` are
// those of the light sample as seen from each of the four points.
geometry::Rays4 rays_to_light(const geometry::Lanes3& start, const geometry::Points4& from,
                              const geometry::Lanes3& direction, const geometry::Lanes& distance, const LightPoint& to);

}  // namespace gradus::light
