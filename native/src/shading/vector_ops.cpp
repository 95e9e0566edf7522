// The Mapping, Vector Rotate and Normal nodes.
#include "shading/op_functions.h"
#include "shading/rotation.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

Vec3 divide(const Vec3& a, const Vec3& b) {
  return Vec3(safe_divide(a.x, b.x), safe_divide(a.y, b.y), safe_divide(a.z, b.z));
}

Vec3 mapped(const OpArgs& args) {
  const Vec3 v = args.v(0), location = args.v(1), scale = args.v(3);
  const Mat3 rotation = euler_matrix(args.v(2));
  switch (args.mode) {
    case GRADUS_MAPPING_TEXTURE:
      return divide(glm::transpose(rotation) * (v - location), scale);
    case GRADUS_MAPPING_VECTOR:
      return rotation * (v * scale);
    case GRADUS_MAPPING_NORMAL:
      return safe_normalize(rotation * divide(v, scale));
    default:
      return rotation * (v * scale) + location;
  }
}

Vec3 rotated(const OpArgs& args) {
  const Vec3 v = args.v(0), center = args.v(1);
  const bool inverse = (args.mode & 8) != 0;
  const uint32_t kind = args.mode & 7;
  if (kind == 4) {
    const Mat3 rotation = euler_matrix(args.v(4));
    return (inverse ? glm::transpose(rotation) : rotation) * (v - center) + center;
  }
  const Vec3 axes[4] = {safe_normalize(args.v(2)), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  const Vec3 axis = axes[kind & 3];
  if (axis == Vec3(0.0f)) return v;
  return rotate_around(v - center, axis, inverse ? -args.f(3) : args.f(3)) + center;
}

}  // namespace

void mapping_op(const OpArgs& args, Vec4* out) { out[0] = value(mapped(args)); }

void vector_rotate_op(const OpArgs& args, Vec4* out) { out[0] = value(rotated(args)); }

void normal_dot_op(const OpArgs& args, Vec4* out) {
  const Vec3 direction = safe_normalize(Vec3(args.floats[0], args.floats[1], args.floats[2]));
  out[0] = value(direction);
  out[1] = splat(glm::dot(direction, safe_normalize(args.v(0))));
}

}  // namespace gradus::shading
