// The nodes Separate Color, Combine Color, Hue/Saturation/Value, Gamma, Invert Color and Brightness/Contrast.
#include "shading/color_models.h"
#include "shading/ops.h"
#include "shading/scalar.h"

namespace gradus::shading {

void separate(const OpArgs& args, Vec4* out) {
  Vec3 c = args.v(0);
  if (args.mode == GRADUS_COLOR_HSV) c = rgb_to_hsv(c);
  if (args.mode == GRADUS_COLOR_HSL) c = rgb_to_hsl(c);
  for (int i = 0; i < 3; i++) out[i] = splat(c[i]);
}

Vec4 combine(const OpArgs& args) {
  const Vec3 c(args.f(0), args.f(1), args.f(2));
  if (args.mode == GRADUS_COLOR_HSV) return value(hsv_to_rgb(c));
  if (args.mode == GRADUS_COLOR_HSL) return value(hsl_to_rgb(c));
  return value(c);
}

Vec4 hue_saturation(const OpArgs& args) {
  const Vec3 color = args.v(4);
  Vec3 hsv = rgb_to_hsv(color);
  hsv.x = fraction(hsv.x + args.f(0) + 0.5f);
  hsv.y = saturate(hsv.y * args.f(1));
  hsv.z *= args.f(2);
  const Vec3 mixed = hsv_to_rgb(hsv) * args.f(3) + color * (1.0f - args.f(3));
  return value(glm::max(mixed, Vec3(0.0f)));
}

Vec4 gamma_op(const OpArgs& args) {
  Vec3 c = args.v(0);
  const float gamma = args.f(1);
  if (gamma == 0.0f) return Vec4(1.0f);
  for (int i = 0; i < 3; i++)
    if (c[i] > 0.0f) c[i] = std::pow(c[i], gamma);
  return value(c);
}

Vec4 invert(const OpArgs& args) {
  const Vec3 c = args.v(1);
  return value((Vec3(1.0f) - c) * args.f(0) + c * (1.0f - args.f(0)));
}

Vec4 bright_contrast(const OpArgs& args) {
  const float slope = 1.0f + args.f(2), offset = args.f(1) - args.f(2) * 0.5f;
  return value(glm::max(args.v(0) * slope + offset, Vec3(0.0f)));
}

}  // namespace gradus::shading
