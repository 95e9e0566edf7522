// The Vector Math node.
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

template <class F>
Vec3 each(const Vec3& a, F f) {
  return Vec3(f(a.x), f(a.y), f(a.z));
}
template <class F>
Vec3 each(const Vec3& a, const Vec3& b, F f) {
  return Vec3(f(a.x, b.x), f(a.y, b.y), f(a.z, b.z));
}

Vec3 project(const Vec3& a, const Vec3& b) {
  const float square = glm::dot(b, b);
  return square != 0.0f ? b * (glm::dot(a, b) / square) : Vec3(0.0f);
}

Vec3 refract(const Vec3& incident, const Vec3& normal, float eta) {
  const float d = glm::dot(normal, incident);
  const float k = 1.0f - eta * eta * (1.0f - d * d);
  return k < 0.0f ? Vec3(0.0f) : incident * eta - normal * (eta * d + std::sqrt(k));
}

Vec3 componentwise(uint32_t mode, const Vec3& a, const Vec3& b, const Vec3& c) {
  switch (mode) {
    case GRADUS_VECTOR_NORMALIZE:
      return safe_normalize(a);
    case GRADUS_VECTOR_ABSOLUTE:
      return glm::abs(a);
    case GRADUS_VECTOR_POWER:
      return each(a, b, safe_power);
    case GRADUS_VECTOR_SIGN:
      return each(a, sign);
    case GRADUS_VECTOR_MINIMUM:
      return glm::min(a, b);
    case GRADUS_VECTOR_MAXIMUM:
      return glm::max(a, b);
    case GRADUS_VECTOR_ROUND:
      return glm::floor(a + 0.5f);
    case GRADUS_VECTOR_FLOOR:
      return glm::floor(a);
    case GRADUS_VECTOR_CEIL:
      return glm::ceil(a);
    case GRADUS_VECTOR_FRACTION:
      return a - glm::floor(a);
    case GRADUS_VECTOR_MODULO:
      return each(a, b, safe_modulo);
    case GRADUS_VECTOR_WRAP:
      return Vec3(wrap(a.x, b.x, c.x), wrap(a.y, b.y, c.y), wrap(a.z, b.z, c.z));
    case GRADUS_VECTOR_SNAP:
      return each(a, b, snap);
    case GRADUS_VECTOR_SINE:
      return each(a, [](float x) { return std::sin(x); });
    case GRADUS_VECTOR_COSINE:
      return each(a, [](float x) { return std::cos(x); });
    case GRADUS_VECTOR_TANGENT:
      return each(a, [](float x) { return std::tan(x); });
    default:
      return Vec3(0.0f);
  }
}

Vec3 vector_result(uint32_t mode, const Vec3& a, const Vec3& b, const Vec3& c, float scale) {
  switch (mode) {
    case GRADUS_VECTOR_ADD:
      return a + b;
    case GRADUS_VECTOR_SUBTRACT:
      return a - b;
    case GRADUS_VECTOR_MULTIPLY:
      return a * b;
    case GRADUS_VECTOR_DIVIDE:
      return each(a, b, safe_divide);
    case GRADUS_VECTOR_MULTIPLY_ADD:
      return a * b + c;
    case GRADUS_VECTOR_CROSS_PRODUCT:
      return glm::cross(a, b);
    case GRADUS_VECTOR_PROJECT:
      return project(a, b);
    case GRADUS_VECTOR_REFLECT: {
      const Vec3 n = safe_normalize(b);
      return a - n * (2.0f * glm::dot(a, n));
    }
    case GRADUS_VECTOR_REFRACT:
      return refract(a, safe_normalize(b), scale);
    case GRADUS_VECTOR_FACEFORWARD:
      return glm::dot(c, b) < 0.0f ? a : -a;
    case GRADUS_VECTOR_SCALE:
      return a * scale;
    default:
      return componentwise(mode, a, b, c);
  }
}

}  // namespace

void vector_math_op(const OpArgs& args, Vec4* out) {
  const Vec3 a = args.v(0), b = args.v(1);
  out[0] = out[1] = Vec4(0.0f);
  switch (args.mode) {
    case GRADUS_VECTOR_DOT_PRODUCT:
      out[1] = splat(glm::dot(a, b));
      return;
    case GRADUS_VECTOR_DISTANCE:
      out[1] = splat(glm::distance(a, b));
      return;
    case GRADUS_VECTOR_LENGTH:
      out[1] = splat(glm::length(a));
      return;
    default:
      out[0] = value(vector_result(args.mode, a, b, args.v(2), args.f(3)));
  }
}

}  // namespace gradus::shading
