// The Raycast node: what a ray meets that starts at any point.
#include <bit>

#include "geometry/mesh.h"
#include "shading/context_ops.h"

namespace gradus::shading {
namespace {

enum Flags : uint32_t { kOnlyLocal = 1 };

bool is_finite_vector(const Vec3& v) { return is_finite(v.x) && is_finite(v.y) && is_finite(v.z); }

// Returns where the ray starts. From the shaded point it leaves the surface without meeting it again.
Vec3 origin_of(const ShadeContext& c, const Vec3& position, const Vec3& direction) {
  if (position == world_position(c)) return geometry::offset_origin(c.scene->surface_point(c.hit), direction);
  return position - c.scene->origin;
}

// Returns whether there is a ray. As in Cycles, one of infinite length is traced, and others that are not finite or
// have no length meet nothing. Cycles finds no direction where the square of its length is 0.
bool is_ray(const Vec3& position, const Vec3& direction, float length) {
  return length > 0.0f && is_finite_vector(position) && is_finite_vector(direction) &&
         glm::dot(direction, direction) > 0.0f;
}

// Traces the ray. As in Cycles, it meets what any ray can see. Returns false if it meets nothing, as for lights and the
// world, which cast none.
bool cast(const ResourceArgs& args, const ShadeContext& c, geometry::Hit* hit) {
  const Vec3 position = args.v(0), direction = args.v(1);
  const float length = args.f(2);
  // There is nothing to trace while vertices are displaced.
  if (!c.scene || !c.scene->accelerator || !c.instance || !is_ray(position, direction, length)) return false;
  const Ray ray{origin_of(c, position, direction), 0.0f, direction, length, c.hit.time};
  return args.mode & kOnlyLocal ? c.scene->intersect_instance(ray, c.hit.instance, hit)
                                : c.scene->intersect(ray, GRADUS_VISIBLE_ALL, hit);
}

// Packs the place of a hit into a register: the bits of its instance plus one and of its primitive, and its barycentric
// coordinates. Zeros stand for a ray that meets nothing.
Vec4 packed(const geometry::Hit& hit) {
  return Vec4(std::bit_cast<float>(hit.instance + 1), std::bit_cast<float>(hit.primitive), hit.uv.x, hit.uv.y);
}

// Finds the place that packed() has stored. Returns false if there is none.
bool unpack(const Vec4& stored, const ShadeContext& c, geometry::Hit* hit) {
  hit->instance = std::bit_cast<uint32_t>(stored.x) - 1;
  hit->primitive = std::bit_cast<uint32_t>(stored.y);
  hit->uv = Vec2(stored.z, stored.w);
  hit->time = c.hit.time;
  return c.scene && hit->instance < c.scene->instances.size() &&
         hit->primitive < c.scene->instances[hit->instance].mesh->triangle_count;
}

}  // namespace

void raycast_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  geometry::Hit hit;
  const bool is_hit = cast(args, c, &hit);
  out[0] = splat(is_hit ? 1.0f : 0.0f);
  out[1] = splat(is_hit && hit.instance == c.hit.instance ? 1.0f : 0.0f);
  out[2] = splat(is_hit ? hit.t : args.f(2));
  out[3] = value(is_hit ? args.v(0) + args.v(1) * hit.t : Vec3(0.0f));
  out[4] =
      value(is_hit ? surface_context(*c.scene, c.scene->surface_point(hit), -args.v(1), c.ray).normal : Vec3(0.0f));
  out[5] = is_hit ? packed(hit) : Vec4(0.0f);
}

void raycast_attribute_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  ShadeContext there;
  if (unpack(args.in[0], c, &there.hit)) {
    there.scene = c.scene;
    there.instance = &c.scene->instances[there.hit.instance];
    return attribute_op(args, there, out);
  }
  for (int i = 0; i < 4; ++i) out[i] = Vec4(0.0f);
}

}  // namespace gradus::shading
