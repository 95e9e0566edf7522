// The nodes Separate Color, Combine Color, Hue/Saturation/Value, Gamma, Invert Color, Brightness/Contrast and RGB to
// BW, and the conversion of a vector to a scalar.
#include "shading/color_models.h"
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {

void separate_op(const OpArgs& args, Vec4* out) {
  Vec3 c = args.v(0);
  if (args.mode == GRADUS_COLOR_HSV) c = rgb_to_hsv(c);
  if (args.mode == GRADUS_COLOR_HSL) c = rgb_to_hsl(c);
  for (int i = 0; i < 3; i++) out[i] = splat(c[i]);
}

void combine_op(const OpArgs& args, Vec4* out) {
  Vec3 c(args.f(0), args.f(1), args.f(2));
  if (args.mode == GRADUS_COLOR_HSV) c = hsv_to_rgb(c);
  if (args.mode == GRADUS_COLOR_HSL) c = hsl_to_rgb(c);
  out[0] = value(c);
}

void hue_saturation_op(const OpArgs& args, Vec4* out) {
  const Vec3 color = args.v(4);
  Vec3 hsv = rgb_to_hsv(color);
  hsv.x = fraction(hsv.x + args.f(0) + 0.5f);
  hsv.y = saturate(hsv.y * args.f(1));
  hsv.z *= args.f(2);
  const Vec3 mixed = hsv_to_rgb(hsv) * args.f(3) + color * (1.0f - args.f(3));
  out[0] = value(glm::max(mixed, Vec3(0.0f)));
}

void gamma_op(const OpArgs& args, Vec4* out) {
  Vec3 c = args.v(0);
  const float gamma = args.f(1);
  if (gamma == 0.0f) c = Vec3(1.0f);
  for (int i = 0; i < 3; i++)
    if (c[i] > 0.0f) c[i] = std::pow(c[i], gamma);
  out[0] = value(c);
}

void invert_op(const OpArgs& args, Vec4* out) {
  const Vec3 c = args.v(1);
  out[0] = value((Vec3(1.0f) - c) * args.f(0) + c * (1.0f - args.f(0)));
}

void bright_contrast_op(const OpArgs& args, Vec4* out) {
  const float slope = 1.0f + args.f(2), offset = args.f(1) - args.f(2) * 0.5f;
  out[0] = value(glm::max(args.v(0) * slope + offset, Vec3(0.0f)));
}

void rgb_to_bw_op(const OpArgs& args, Vec4* out) { out[0] = splat(luminance(args.v(0))); }

void average_op(const OpArgs& args, Vec4* out) { out[0] = splat(mean_component(args.v(0))); }

}  // namespace gradus::shading
