// Shadow rays through transparent surfaces.
#include "geometry/accelerator.h"
#include "scene/snapshot.h"
#include "shading/shade.h"

namespace gradus::scene {

namespace {

// Returns the transmittance of a segment through the transparent surfaces that `nearest` finds.
template <class Nearest>
Rgb through_transparent(const Snapshot& scene, const Ray& ray, uint32_t max_transparent, Nearest&& nearest) {
  Rgb through(1.0f);
  Ray remaining = ray;
  float passed = 0.0f;
  shading::RayState state;
  state.flags = shading::kRayShadow;
  geometry::Hit hit;
  for (uint32_t n = 0; nearest(remaining, &hit); ++n) {
    if (n >= max_transparent) return Rgb(0.0f);
    const geometry::SurfacePoint point = scene.surface_point(hit);
    state.length = passed + hit.t;
    state.transparent_depth = uint16_t(n);
    through *= shading::shade_transparency(scene, point, -remaining.direction, state);
    if (is_black(through)) return Rgb(0.0f);
    passed += geometry::pass_surface(point, &remaining);
  }
  return through;
}

}  // namespace

Rgb Snapshot::transmittance(const Ray& ray, uint32_t max_transparent) const {
  if (!features.has_transparent_shadows) return occluded(ray) ? Rgb(0.0f) : Rgb(1.0f);
  // Opaque surfaces decide most rays without the evaluation of a material.
  if (geometry::trace_any(*accelerator, ray, geometry::kMaskOpaqueShadow)) return Rgb(0.0f);
  return through_transparent(*this, ray, max_transparent, [&](const Ray& part, geometry::Hit* hit) {
    return geometry::trace_nearest(*accelerator, part, geometry::kMaskTransparentShadow, hit);
  });
}

Rgb Snapshot::transmittance(const Ray& ray, uint32_t max_transparent, uint64_t blockers) const {
  geometry::Hit opaque;
  if (intersect_blocker(ray, geometry::kMaskOpaqueShadow, blockers, &opaque)) return Rgb(0.0f);
  if (!features.has_transparent_shadows) return Rgb(1.0f);
  return through_transparent(*this, ray, max_transparent, [&](const Ray& part, geometry::Hit* hit) {
    return intersect_blocker(part, geometry::kMaskTransparentShadow, blockers, hit);
  });
}

}  // namespace gradus::scene
