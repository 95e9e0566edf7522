// Shadow rays through transparent surfaces.
#include "geometry/accelerator.h"
#include "scene/snapshot.h"
#include "shading/shade.h"

namespace gradus {

Rgb Snapshot::transmittance(const Ray& ray, uint32_t max_transparent) const {
  if (!features.has_transparent_shadows) return occluded(ray) ? Rgb(0.0f) : Rgb(1.0f);
  // What is opaque for sure decides most rays, and no material has to run.
  if (trace_any(*accelerator, ray, kMaskOpaqueShadow)) return Rgb(0.0f);
  Rgb through(1.0f);
  Ray rest = ray;
  float passed = 0.0f;
  RayState state;
  state.flags = kRayShadow;
  Hit hit;
  for (uint32_t n = 0; trace_nearest(*accelerator, rest, kMaskTransparentShadow, &hit); ++n) {
    if (n >= max_transparent) return Rgb(0.0f);
    const SurfacePoint point = surface_point(hit);
    state.length = passed + hit.t;
    state.transparent_depth = uint16_t(n);
    through *= shade_transparency(*this, point, -rest.direction, state);
    if (is_black(through)) return Rgb(0.0f);
    passed += pass_surface(point, &rest);
  }
  return through;
}

}  // namespace gradus
