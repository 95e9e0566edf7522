// The Tangent and Normal Map nodes.
#include "base/minimal_rotation.h"
#include "geometry/surface_values.h"
#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Rotates a tangent of the undeformed mesh as the smooth normal rotates from there to the time of the hit.
Vec4 turned_with_surface(const ShadeContext& c, const Vec4& tangent) {
  Vec3 frame_normal, hit_normal;
  if (!geometry::turned_normals_at(*c.instance, c.hit, &frame_normal, &hit_normal)) return tangent;
  return Vec4(turned(Vec3(tangent), safe_normalize(frame_normal), safe_normalize(hit_normal)), tangent.w);
}

Vec3 unflipped(const ShadeContext& c) { return c.backfacing ? -c.normal : c.normal; }

// Returns the interpolated normal in the object's space. A smooth normal is not normalised, because normal map bakers,
// and Cycles before Blender 5.2, build the frame that way.
Vec3 local_normal(const ShadeContext& c) {
  Vec3 normal;
  return geometry::smooth_normal_at(*c.instance, c.hit, &normal) ? normal : normal_to_local(c, unflipped(c));
}

// Returns a normal that lies between that of the surface and `n`, or beyond it.
Vec3 blended(const ShadeContext& c, const Vec3& n, float strength) {
  return strength == 1.0f ? n : safe_normalize(c.normal + (n - c.normal) * std::max(strength, 0.0f));
}

Vec3 tangent_space_normal(const ResourceArgs& args, const ShadeContext& c, Vec3 color, float strength) {
  const Vec4 frame = uv_tangent(c, args.name);
  const Vec3 tangent(frame);
  if (tangent == Vec3(0.0f)) return c.normal;
  const Vec3 interpolated = local_normal(c);
  const Vec3 n = args.mode == GRADUS_NORMAL_UNIT_TANGENT ? safe_normalize(interpolated) : interpolated;
  color.x *= strength;
  color.y *= strength;
  color.z = 1.0f + (color.z - 1.0f) * saturate(strength);
  const Vec3 bitangent = glm::cross(n, tangent) * frame.w;
  const Vec3 local = tangent * color.x + bitangent * color.y + n * color.z;
  const Vec3 world = normal_to_world(c, local);
  return c.backfacing ? -world : world;
}

Vec3 own_tangent(const ResourceArgs& args, const ShadeContext& c) {
  Vec3 direction;
  if (args.mode == GRADUS_TANGENT_UV) {
    // As in Cycles the matrix of normals transforms the tangent, which rotates it on an object of non-uniform scale.
    direction = normal_to_world(c, Vec3(uv_tangent(c, args.name)));
  } else {
    const Vec3 g = (c.instance ? generated(c) : world_position(c)) - 0.5f;
    const Vec3 around[3] = {Vec3(0.0f, -g.z, g.y), Vec3(-g.z, 0.0f, g.x), Vec3(-g.y, g.x, 0.0f)};
    direction = normal_to_world(c, around[std::min(args.mode, 2u)]);
  }
  return safe_normalize(glm::cross(c.normal, safe_normalize(glm::cross(direction, c.normal))));
}

Vec3 mapped_normal(const ResourceArgs& args, const ShadeContext& c) {
  const float strength = args.f(0);
  Vec3 color = (args.v(1) - 0.5f) * 2.0f;
  if (is_tangent_space(args.mode)) {
    const bool is_blended = args.mode == GRADUS_NORMAL_BLENDED_TANGENT;
    Vec3 n = tangent_space_normal(args, c, color, is_blended ? 1.0f : std::max(strength, 0.0f));
    if (is_blended) n = blended(c, n, strength);
    return n == Vec3(0.0f) ? c.normal : n;
  }
  if (args.mode == GRADUS_NORMAL_BLENDER_OBJECT || args.mode == GRADUS_NORMAL_BLENDER_WORLD) {
    color.y = -color.y;
    color.z = -color.z;
  }
  const bool local = args.mode == GRADUS_NORMAL_OBJECT || args.mode == GRADUS_NORMAL_BLENDER_OBJECT;
  Vec3 n = local ? normal_to_world(c, color) : safe_normalize(color);
  if (c.backfacing) n = -n;
  n = blended(c, n, strength);
  return n == Vec3(0.0f) ? c.normal : n;
}

}  // namespace

Vec4 uv_tangent(const ShadeContext& c, const std::string* name) {
  if (!c.instance) return Vec4(0.0f);
  const geometry::MeshData& mesh = *c.instance->mesh;
  const geometry::MeshAttribute* uv = geometry::uv_map(mesh, name ? std::string_view(*name) : std::string_view());
  for (const auto& field : c.instance->tangents)
    if (field->uv == uv) return turned_with_surface(c, geometry::tangent_at(*field, c.hit));
  return Vec4(0.0f);
}

void tangent_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  out[0] = value(own_tangent(args, center_of(c)));
}

void normal_map_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  out[0] = value(mapped_normal(args, center_of(c)));
}

}  // namespace gradus::shading
