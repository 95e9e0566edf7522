// The Raycast node: what a ray meets that starts at any point.
#include "shading/context_ops.h"

namespace gradus::shading {
namespace {

enum Flags : uint32_t { kOnlyLocal = 1 };

// A surface that a ray meets, as the ray sees it, and the way there in lengths of the direction.
struct Found {
  ShadeContext at;
  float distance;
};

// Returns where the ray starts. From the shaded point it leaves the surface without meeting it again.
Vec3 origin_of(const ShadeContext& c, const Vec3& position, const Vec3& direction) {
  if (position == world_position(c)) return geometry::offset_origin(c.scene->surface_point(c.hit), direction);
  return position - c.scene->origin;
}

// Traces the ray. As in Cycles, it meets what any ray can see. Returns false if it meets nothing, as for lights and the
// world, which cast none.
bool cast(const ResourceArgs& args, const ShadeContext& c, Found* found) {
  const Vec3 direction = args.v(1);
  const float length = args.f(2);
  // There is nothing to trace while vertices are displaced.
  if (!c.scene || !c.scene->accelerator || !c.instance || !(length > 0.0f) || direction == Vec3(0.0f)) return false;
  const Ray ray{origin_of(c, args.v(0), direction), 0.0f, direction, length, c.hit.time};
  geometry::Hit hit;
  const bool is_hit = args.mode & kOnlyLocal ? c.scene->intersect_instance(ray, c.hit.instance, &hit)
                                             : c.scene->intersect(ray, GRADUS_VISIBLE_ALL, &hit);
  if (!is_hit) return false;
  *found = {surface_context(*c.scene, c.scene->surface_point(hit), -direction, c.ray), hit.t};
  return true;
}

}  // namespace

void raycast_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  Found found;
  const bool is_hit = cast(args, c, &found);
  out[0] = splat(is_hit ? 1.0f : 0.0f);
  out[1] = splat(is_hit && found.at.hit.instance == c.hit.instance ? 1.0f : 0.0f);
  out[2] = splat(is_hit ? found.distance : args.f(2));
  out[3] = value(is_hit ? args.v(0) + args.v(1) * found.distance : Vec3(0.0f));
  out[4] = value(is_hit ? found.at.normal : Vec3(0.0f));
}

void raycast_attribute_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  Found found;
  if (cast(args, c, &found)) return attribute_op(args, found.at, out);
  for (int i = 0; i < 4; ++i) out[i] = Vec4(0.0f);
}

}  // namespace gradus::shading
