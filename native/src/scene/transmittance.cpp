// Shadow rays through transparent surfaces.
#include "geometry/accelerator.h"
#include "scene/snapshot.h"
#include "shading/shade.h"

namespace gradus::scene {

Rgb Snapshot::transmittance(const Ray& ray, uint32_t max_transparent) const {
  if (!features.has_transparent_shadows) return occluded(ray) ? Rgb(0.0f) : Rgb(1.0f);
  // Opaque surfaces decide most rays without the evaluation of a material.
  if (geometry::trace_any(*accelerator, ray, geometry::kMaskOpaqueShadow)) return Rgb(0.0f);
  Rgb through(1.0f);
  Ray remaining = ray;
  float passed = 0.0f;
  shading::RayState state;
  state.flags = shading::kRayShadow;
  geometry::Hit hit;
  for (uint32_t n = 0; geometry::trace_nearest(*accelerator, remaining, geometry::kMaskTransparentShadow, &hit); ++n) {
    if (n >= max_transparent) return Rgb(0.0f);
    const geometry::SurfacePoint point = surface_point(hit);
    state.length = passed + hit.t;
    state.transparent_depth = uint16_t(n);
    through *= shading::shade_transparency(*this, point, -remaining.direction, state);
    if (is_black(through)) return Rgb(0.0f);
    passed += geometry::pass_surface(point, &remaining);
  }
  return through;
}

}  // namespace gradus::scene
