// The Mix node, for values and for colours with its blend modes. It does not clamp the factor.
#include "shading/color_models.h"
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

Vec3 lerp(const Vec3& a, const Vec3& b, float t) { return a + (b - a) * t; }

float overlay(float a, float b, float t) {
  const float complement = 1.0f - t;
  return a < 0.5f ? a * (complement + 2.0f * t * b) : 1.0f - (complement + 2.0f * t * (1.0f - b)) * (1.0f - a);
}

float divide(float a, float b, float t) { return b != 0.0f ? (1.0f - t) * a + t * a / b : a; }

float dodge(float a, float b, float t) {
  if (a == 0.0f) return a;
  const float d = 1.0f - t * b;
  return d <= 0.0f ? 1.0f : std::min(a / d, 1.0f);
}

float burn(float a, float b, float t) {
  const float d = 1.0f - t + t * b;
  return d <= 0.0f ? 0.0f : saturate(1.0f - (1.0f - a) / d);
}

template <class F>
Vec3 each(const Vec3& a, const Vec3& b, float t, F f) {
  return Vec3(f(a.x, b.x, t), f(a.y, b.y, t), f(a.z, b.z, t));
}

Vec3 soft_light(const Vec3& a, const Vec3& b, float t) {
  const Vec3 screen = Vec3(1.0f) - (Vec3(1.0f) - b) * (Vec3(1.0f) - a);
  return a * (1.0f - t) + ((Vec3(1.0f) - a) * b * a + a * screen) * t;
}

Vec3 blend_hsv(uint32_t mode, const Vec3& a, const Vec3& b, float t) {
  Vec3 hsv = rgb_to_hsv(a);
  const Vec3 other = rgb_to_hsv(b);
  switch (mode) {
    case GRADUS_BLEND_HUE:
      return other.y != 0.0f ? lerp(a, hsv_to_rgb(Vec3(other.x, hsv.y, hsv.z)), t) : a;
    case GRADUS_BLEND_COLOR:
      return other.y != 0.0f ? lerp(a, hsv_to_rgb(Vec3(other.x, other.y, hsv.z)), t) : a;
    case GRADUS_BLEND_SATURATION:
      if (hsv.y == 0.0f) return a;
      hsv.y = (1.0f - t) * hsv.y + t * other.y;
      return hsv_to_rgb(hsv);
    default:
      hsv.z = (1.0f - t) * hsv.z + t * other.z;
      return hsv_to_rgb(hsv);
  }
}

Vec3 blend(uint32_t mode, const Vec3& a, const Vec3& b, float t) {
  switch (mode) {
    case GRADUS_BLEND_MIX:
      return lerp(a, b, t);
    case GRADUS_BLEND_DARKEN:
      return lerp(a, glm::min(a, b), t);
    case GRADUS_BLEND_MULTIPLY:
      return lerp(a, a * b, t);
    case GRADUS_BLEND_BURN:
      return each(a, b, t, burn);
    case GRADUS_BLEND_LIGHTEN:
      return lerp(a, glm::max(a, b), t);
    case GRADUS_BLEND_SCREEN:
      return Vec3(1.0f) - (Vec3(1.0f - t) + (Vec3(1.0f) - b) * t) * (Vec3(1.0f) - a);
    case GRADUS_BLEND_DODGE:
      return each(a, b, t, dodge);
    case GRADUS_BLEND_ADD:
      return a + b * t;
    case GRADUS_BLEND_OVERLAY:
      return each(a, b, t, overlay);
    case GRADUS_BLEND_SOFT_LIGHT:
      return soft_light(a, b, t);
    case GRADUS_BLEND_LINEAR_LIGHT:
      return a + (b * 2.0f - 1.0f) * t;
    case GRADUS_BLEND_DIFFERENCE:
      return lerp(a, glm::abs(a - b), t);
    case GRADUS_BLEND_EXCLUSION:
      return glm::max(lerp(a, a + b - a * b * 2.0f, t), Vec3(0.0f));
    case GRADUS_BLEND_SUBTRACT:
      return a - b * t;
    case GRADUS_BLEND_DIVIDE:
      return each(a, b, t, divide);
    default:
      return blend_hsv(mode, a, b, t);
  }
}

}  // namespace

void mix_op(const OpArgs& args, Vec4* out) { out[0] = args.in[1] + (args.in[2] - args.in[1]) * args.in[0]; }

void mix_color_op(const OpArgs& args, Vec4* out) {
  const Vec3 mixed = blend(args.mode & 31, args.v(1), args.v(2), args.f(0));
  out[0] = value(args.mode & 32 ? glm::clamp(mixed, 0.0f, 1.0f) : mixed);
}

}  // namespace gradus::shading
