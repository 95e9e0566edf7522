// The Displacement and Vector Displacement nodes.
#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

Vec3 direction_to_world(const ShadeContext& c, const Vec3& v) {
  geometry::Placement storage;
  return c.instance ? Mat3(placement_of(c, &storage).to_world) * v : v;
}

// Returns the direction around the z axis of the generated coordinates in the plane of `normal`, which Cycles takes as
// the tangent of a mesh without a UV map.
Vec3 tangent_around_z(const ShadeContext& c, const Vec3& normal) {
  const Vec3 g = generated(c) - 0.5f, around(-g.y, g.x, 0.0f);
  return safe_normalize(around - normal * glm::dot(around, normal));
}

// Returns a vector of tangent space in the object's space. As in Cycles, the second axis is the normal.
Vec3 from_tangent_space(const ShadeContext& c, const Vec3& v) {
  const Vec3 normal = normal_to_local(c, c.normal);
  const Vec4 of_map = uv_tangent(c, nullptr);
  Vec3 tangent(of_map);
  float handedness = of_map.w;
  if (tangent == Vec3(0.0f)) {
    tangent = tangent_around_z(c, normal);
    handedness = 1.0f;
  }
  const Vec3 bitangent = safe_normalize(glm::cross(normal, tangent)) * handedness;
  return tangent * v.x + normal * v.y + bitangent * v.z;
}

}  // namespace

void displacement_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const Vec3 normal = args.v(3) == Vec3(0.0f) ? c.normal : args.v(3);
  const float height = (args.f(0) - args.f(1)) * args.f(2);
  out[0] = value(args.mode == GRADUS_NORMAL_OBJECT ? direction_to_world(c, normal_to_local(c, normal) * height)
                                                   : normal * height);
}

void vector_displacement_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) {
  const Vec3 v = (args.v(0) - args.f(1)) * args.f(2);
  if (args.mode == GRADUS_NORMAL_WORLD)
    out[0] = value(v);
  else
    out[0] = value(direction_to_world(c, args.mode == GRADUS_NORMAL_TANGENT ? from_tangent_space(center_of(c), v) : v));
}

}  // namespace gradus::shading
