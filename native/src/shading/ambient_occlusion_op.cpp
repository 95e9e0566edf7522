// The Ambient Occlusion node.
#include "base/orthonormal_basis.h"
#include "bsdf/warp.h"
#include "shading/context_ops.h"
#include "shading/random_rays.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

enum Flags : uint32_t { kInside = 1, kOnlyLocal = 2, kWorldDistance = 4 };

bool is_occluded(const ShadeContext& c, const Ray& ray, bool only_local) {
  geometry::Hit hit;
  return only_local ? c.scene->intersect_instance(ray, c.hit.instance, &hit) : c.scene->occluded(ray);
}

// Returns the share of rays that meet nothing. The hemisphere of a shading normal reaches below the surface, as in
// Cycles.
float openness(const ResourceArgs& args, const ShadeContext& c) {
  const float distance = args.mode & kWorldDistance ? c.scene->world.ao_distance : args.f(1);
  const uint32_t count = ray_count(args);
  if (!(distance > 0.0f) || count == 0) return 1.0f;
  const Vec3 own = safe_normalize(args.v(2));
  const Vec3 outward = own == Vec3(0.0f) ? c.normal : own;
  const Vec3 z = args.mode & kInside ? -outward : outward;
  Vec3 x, y;
  orthonormal_basis(z, &x, &y);
  const geometry::SurfacePoint point = c.scene->surface_point(c.hit);
  const RandomPoints points(c, count);
  uint32_t open = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3 local = bsdf::sample_cosine_hemisphere(points[i]);
    const Vec3 direction = x * local.x + y * local.y + z * local.z;
    const Ray ray{geometry::offset_origin(point, direction), 0.0f, direction, distance, c.hit.time};
    if (!is_occluded(c, ray, (args.mode & kOnlyLocal) != 0)) ++open;
  }
  return static_cast<float>(open) / static_cast<float>(count);
}

}  // namespace

void ambient_occlusion_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  // There is nothing to trace while vertices are displaced.
  const float factor = c.scene && c.scene->accelerator && c.instance ? openness(args, c) : 1.0f;
  out[0] = value(args.v(0) * factor);
  out[1] = splat(factor);
}

}  // namespace gradus::shading
