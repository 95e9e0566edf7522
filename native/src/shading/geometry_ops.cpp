// The Geometry node.
#include <cmath>

#include "geometry/surface_values.h"
#include "shading/context_ops.h"
#include "shading/lattice_hash.h"
#include "shading/scalar.h"

namespace gradus::shading {

Vec3 generated(const ShadeContext& c) {
  if (!c.instance) return local_position(c);
  return geometry::generated_at(*c.instance, c.hit);
}

Vec3 local_position(const ShadeContext& c) {
  geometry::Placement storage;
  return object_of(c) ? Vec3(placement_of(c, &storage).to_local * Vec4(c.position, 1.0f)) : world_position(c);
}

Vec3 default_tangent(const ShadeContext& c) {
  if (c.light) return Vec3(NAN);  // as in Cycles, where a light has no tangents to normalise
  if (!c.instance) return Vec3(1, 0, 0);
  const Vec3 g = generated(c) - 0.5f;
  const Vec3 around = normal_to_world(c, Vec3(-g.y, g.x, 0.0f));
  return safe_normalize(glm::cross(c.normal, safe_normalize(glm::cross(around, c.normal))));
}

namespace {

float random_per_island(const ShadeContext& c) {
  uint32_t island = 0;
  return c.instance && geometry::island_at(*c.instance, c.hit, &island) ? unit_hash(island) : 0.0f;
}

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
      return c.light ? Vec3(c.light->uv, 0.0f) : geometry::parametric_at(c.hit);
    case GRADUS_GEOMETRY_BACKFACING:
      return Vec3(c.backfacing ? 1.0f : 0.0f);
    case GRADUS_GEOMETRY_POINTINESS:
      return Vec3(c.instance ? geometry::pointiness_at(*c.instance, c.hit) : 0.0f);
    case GRADUS_GEOMETRY_RANDOM_PER_ISLAND:
      return Vec3(random_per_island(c));
    default:
      return world_position(c);
  }
}

}  // namespace

void geometry_op(const ResourceArgs& args, const ShadeContext& c, Vec4* out) { out[0] = value(quantity(args.mode, c)); }

}  // namespace gradus::shading
