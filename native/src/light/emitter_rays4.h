// Four shadow rays towards one emitter point.
#pragma once

#include "geometry/rays4.h"
#include "light/light_sampling.h"

namespace gradus::light {

// ray_to_light() from each of four points. direction and distance: of the emitter point, as seen from each.
geometry::Rays4 rays_to_light(const geometry::Lanes3& start, const geometry::Points4& from,
                              const geometry::Lanes3& direction, const geometry::Lanes& distance,
                              const LightPoint& to);

}  // namespace gradus::light
