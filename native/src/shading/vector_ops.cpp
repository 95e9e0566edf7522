// The Mapping and Vector Rotate nodes.
#include "shading/ops.h"
#include "shading/rotation.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

Vec3 divide(const Vec3& a, const Vec3& b) {
  return Vec3(safe_divide(a.x, b.x), safe_divide(a.y, b.y), safe_divide(a.z, b.z));
}

}  // namespace

Vec4 mapping(const OpArgs& args) {
  const Vec3 v = args.v(0), location = args.v(1), scale = args.v(3);
  const Mat3 rotation = euler_matrix(args.v(2));
  switch (args.mode) {
    case GRADUS_MAPPING_TEXTURE:
      return value(divide(glm::transpose(rotation) * (v - location), scale));
    case GRADUS_MAPPING_VECTOR:
      return value(rotation * (v * scale));
    case GRADUS_MAPPING_NORMAL:
      return value(safe_normalize(rotation * divide(v, scale)));
    default:
      return value(rotation * (v * scale) + location);
  }
}

Vec4 vector_rotate(const OpArgs& args) {
  const Vec3 v = args.v(0), center = args.v(1);
  const bool inverse = (args.mode & 8) != 0;
  const uint32_t kind = args.mode & 7;
  if (kind == 4) {
    const Mat3 rotation = euler_matrix(args.v(4));
    return value((inverse ? glm::transpose(rotation) : rotation) * (v - center) + center);
  }
  const Vec3 axes[4] = {safe_normalize(args.v(2)), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  const Vec3 axis = axes[kind & 3];
  if (axis == Vec3(0.0f)) return value(v);
  return value(rotate_around(v - center, axis, inverse ? -args.f(3) : args.f(3)) + center);
}

}  // namespace gradus::shading
