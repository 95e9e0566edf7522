// The Geometry node.
#include "geometry/surface_values.h"
#include "shading/context_ops.h"
#include "shading/scalar.h"

namespace gradus::shading {

Vec3 generated(const ShadeContext& c) {
  if (!c.instance) return world_position(c);
  return geometry::generated_at(*c.instance, c.hit);
}

Vec3 default_tangent(const ShadeContext& c) {
  if (!c.instance) return Vec3(1, 0, 0);
  const Vec3 g = generated(c) - 0.5f;
  const Vec3 around = normal_to_world(c, Vec3(-g.y, g.x, 0.0f));
  return safe_normalize(glm::cross(c.normal, safe_normalize(glm::cross(around, c.normal))));
}

namespace {

Vec3 quantity(uint32_t mode, const ShadeContext& c) {
  switch (mode) {
    case GRADUS_GEOMETRY_NORMAL:
      return c.normal;
    case GRADUS_GEOMETRY_TANGENT:
      return default_tangent(c);
    case GRADUS_GEOMETRY_TRUE_NORMAL:
      return c.geometric_normal;
    case GRADUS_GEOMETRY_INCOMING:
      return c.wo;
    case GRADUS_GEOMETRY_PARAMETRIC:
      return c.light_axes ? Vec3(c.uv, 0.0f) : geometry::parametric_at(c.hit);
    case GRADUS_GEOMETRY_BACKFACING:
      return Vec3(c.backfacing ? 1.0f : 0.0f);
    default:
      return world_position(c);
  }
}

}  // namespace

void geometry_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) { out[0] = value(quantity(args.mode, c)); }

}  // namespace gradus::shading
