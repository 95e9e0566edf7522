// Four shadow rays towards one emitter point.
#pragma once

#include "light/light_sampling.h"
#include "geometry/rays4.h"

namespace gradus {

// ray_to_light() from each of four points. direction and distance: of the emitter point, as seen from each.
Rays4 rays_to_light(const Lanes3& start, const Points4& from, const Lanes3& direction, const Lanes& distance, const LightPoint& to);

}  // namespace gradus
