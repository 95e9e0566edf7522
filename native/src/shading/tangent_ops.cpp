// Tangent and Normal Map nodes. UV tangents are those of the triangle, made orthogonal to the interpolated normal.
#include "scene/mesh.h"
#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus {
namespace {

struct TangentFrame {
  Vec3 tangent = Vec3(0.0f);  // zero: the mesh has no usable UV map
  float handedness = 1.0f;
};

// In the object's space.
TangentFrame uv_tangent(const ShadeContext& c, const std::string* name, const Vec3& local_normal) {
  TangentFrame frame;
  if (!c.instance) return frame;
  const MeshData& mesh = *c.instance->mesh;
  const MeshAttribute* uv = name ? find_attribute(mesh, *name) : default_uv_map(mesh);
  if (!uv) return frame;
  const std::array<Vec4, 3> t = corner_values(mesh, *uv, c.hit.triangle);
  const std::array<Vec3, 3> p = triangle_positions(mesh, c.hit.triangle);
  const Vec2 d1 = Vec2(t[1]) - Vec2(t[0]), d2 = Vec2(t[2]) - Vec2(t[0]);
  const float area = d1.x * d2.y - d2.x * d1.y;
  if (area == 0.0f || !is_finite(area)) return frame;
  frame.handedness = area > 0.0f ? 1.0f : -1.0f;
  const Vec3 along_u = ((p[1] - p[0]) * d2.y - (p[2] - p[0]) * d1.y) * frame.handedness;
  frame.tangent = safe_normalize(along_u - local_normal * glm::dot(local_normal, along_u));
  return frame;
}

Vec3 unflipped(const ShadeContext& c) { return c.backfacing ? -c.normal : c.normal; }

Vec3 tangent_space_normal(const ResourceArgs& args, const ShadeContext& c, Vec3 color, float strength) {
  const Vec3 n = normal_to_local(c, unflipped(c));
  const TangentFrame frame = uv_tangent(c, args.name, n);
  if (frame.tangent == Vec3(0.0f)) return c.normal;
  color.x *= strength;
  color.y *= strength;
  color.z = 1.0f + (color.z - 1.0f) * saturate(strength);
  const Vec3 bitangent = glm::cross(n, frame.tangent) * frame.handedness;
  const Vec3 local = frame.tangent * color.x + bitangent * color.y + n * color.z;
  const Vec3 world = normal_to_world(c, local);
  return c.backfacing ? -world : world;
}

}  // namespace

Vec3 tangent(const ResourceArgs& args, const ShadeContext& c) {
  Vec3 direction;
  if (args.mode == GRADUS_TANGENT_UV) {
    const Vec3 local = uv_tangent(c, args.name, normal_to_local(c, unflipped(c))).tangent;
    direction = c.instance ? Mat3(c.instance->to_world) * local : local;
  } else {
    const Vec3 g = generated(c) - 0.5f;
    const Vec3 around[3] = {Vec3(0.0f, -g.z, g.y), Vec3(-g.z, 0.0f, g.x), Vec3(-g.y, g.x, 0.0f)};
    direction = normal_to_world(c, around[std::min(args.mode, 2u)]);
  }
  return safe_normalize(glm::cross(c.normal, safe_normalize(glm::cross(direction, c.normal))));
}

Vec3 normal_map(const ResourceArgs& args, const ShadeContext& c) {
  const float strength = args.f(0);
  Vec3 color = (args.v(1) - 0.5f) * 2.0f;
  if (args.mode == GRADUS_NORMAL_TANGENT) {
    const Vec3 n = tangent_space_normal(args, c, color, std::max(strength, 0.0f));
    return n == Vec3(0.0f) ? c.normal : n;
  }
  if (args.mode == GRADUS_NORMAL_BLENDER_OBJECT || args.mode == GRADUS_NORMAL_BLENDER_WORLD) {
    color.y = -color.y;
    color.z = -color.z;
  }
  const bool local = args.mode == GRADUS_NORMAL_OBJECT || args.mode == GRADUS_NORMAL_BLENDER_OBJECT;
  Vec3 n = local ? normal_to_world(c, color) : safe_normalize(color);
  if (c.backfacing) n = -n;
  if (strength != 1.0f) n = safe_normalize(c.normal + (n - c.normal) * std::max(strength, 0.0f));
  return n == Vec3(0.0f) ? c.normal : n;
}

}  // namespace gradus
