#include "light/light_rays4.h"

namespace gradus::light {

geometry::Rays4 rays_to_light(const geometry::Lanes3& start, const geometry::Points4& from,
                              const geometry::Lanes3& direction, const geometry::Lanes& distance,
                              const LightPoint& to) {
  if (to.at_infinity()) return {start, direction, geometry::same(kInfinity), from.time};
  if (to.kind == LightKind::Triangle) {
    const geometry::Points4 end{geometry::same(to.position), geometry::same(to.normal), geometry::same(to.error),
                                from.time};
    return geometry::rays_between(start, geometry::offset_origins(end, -direction), direction, from.time);
  }
  return geometry::rays_between(start, from.position + direction * distance, direction, from.time);
}

}  // namespace gradus::light
