#include "light/emitter_rays4.h"

namespace gradus {

Rays4 rays_to_light(const Lanes3& start, const Points4& from, const Lanes3& direction, const Lanes& distance, const LightPoint& to) {
  if (to.at_infinity()) return {start, direction, same(kInfinity), from.time};
  if (to.kind == LightKind::Triangle) {
    const Points4 end{same(to.position), same(to.normal), same(to.error), from.time};
    return rays_between(start, offset_origins(end, -direction), direction, from.time);
  }
  return rays_between(start, from.position + direction * distance, direction, from.time);
}

}  // namespace gradus
