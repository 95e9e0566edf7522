// Dispatch of the pure operations.
#include "shading/ops.h"
#include "shading/scalar.h"
#include "shading/sky/sky.h"

namespace gradus::shading {
namespace {

Vec4 mix(const OpArgs& args) { return args.in[1] + (args.in[2] - args.in[1]) * args.in[0]; }

void normal_dot(const OpArgs& args, Vec4* out) {
  const Vec3 direction = safe_normalize(Vec3(args.floats[0], args.floats[1], args.floats[2]));
  out[0] = value(direction);
  out[1] = splat(glm::dot(direction, safe_normalize(args.v(0))));
}

bool evaluate_texture(uint32_t op, const OpArgs& args, Vec4* out) {
  switch (op) {
    case GRADUS_OP_NOISE:
      noise_op(args, out);
      return true;
    case GRADUS_OP_CHECKER:
      checker(args, out);
      return true;
    case GRADUS_OP_GRADIENT:
      out[0] = gradient(args);
      return true;
    case GRADUS_OP_WHITE_NOISE:
      white_noise(args, out);
      return true;
    case GRADUS_OP_WAVE:
      out[0] = wave(args);
      return true;
    case GRADUS_OP_MAGIC:
      magic(args, out);
      return true;
    case GRADUS_OP_BRICK:
      brick(args, out);
      return true;
    case GRADUS_OP_SKY:
      out[0] = value(sky(args.mode, args.floats, args.v(0)));
      return true;
    default:
      return false;
  }
}

bool evaluate_color(uint32_t op, const OpArgs& args, Vec4* out) {
  switch (op) {
    case GRADUS_OP_MIX_COLOR:
      out[0] = mix_color(args);
      return true;
    case GRADUS_OP_SEPARATE:
      separate(args, out);
      return true;
    case GRADUS_OP_COMBINE:
      out[0] = combine(args);
      return true;
    case GRADUS_OP_HUE_SATURATION:
      out[0] = hue_saturation(args);
      return true;
    case GRADUS_OP_GAMMA:
      out[0] = gamma_op(args);
      return true;
    case GRADUS_OP_INVERT:
      out[0] = invert(args);
      return true;
    case GRADUS_OP_BRIGHT_CONTRAST:
      out[0] = bright_contrast(args);
      return true;
    case GRADUS_OP_RGB_TO_BW:
      out[0] = splat(luminance(args.v(0)));
      return true;
    case GRADUS_OP_AVERAGE:
      out[0] = splat(mean_component(args.v(0)));
      return true;
    case GRADUS_OP_BLACKBODY:
      out[0] = value(blackbody(args.f(0)));
      return true;
    default:
      return evaluate_texture(op, args, out);
  }
}

}  // namespace

bool evaluate_pure(uint32_t op, const OpArgs& args, Vec4* out) {
  switch (op) {
    case GRADUS_OP_MATH: {
      const float r = math(args.mode & 63, args.f(0), args.f(1), args.f(2));
      out[0] = splat(args.mode & 64 ? std::min(std::max(r, 0.0f), 1.0f) : r);
      return true;
    }
    case GRADUS_OP_MIX:
      out[0] = mix(args);
      return true;
    case GRADUS_OP_VECTOR_MATH:
      vector_math(args, out);
      return true;
    case GRADUS_OP_MAPPING:
      out[0] = mapping(args);
      return true;
    case GRADUS_OP_VECTOR_ROTATE:
      out[0] = vector_rotate(args);
      return true;
    case GRADUS_OP_CLAMP:
      out[0] = clamp_op(args);
      return true;
    case GRADUS_OP_MAP_RANGE:
      out[0] = map_range(args);
      return true;
    case GRADUS_OP_RAMP:
      ramp(args, out);
      return true;
    case GRADUS_OP_CURVES:
      out[0] = curves(args);
      return true;
    case GRADUS_OP_NORMAL_DOT:
      normal_dot(args, out);
      return true;
    default:
      return evaluate_color(op, args, out);
  }
}

bool is_pure(uint32_t op) {
  switch (op) {
    case GRADUS_OP_NOISE:
    case GRADUS_OP_CHECKER:
    case GRADUS_OP_GRADIENT:
    case GRADUS_OP_WHITE_NOISE:
    case GRADUS_OP_WAVE:
    case GRADUS_OP_MAGIC:
    case GRADUS_OP_BRICK:
    case GRADUS_OP_SKY:
      return true;
    default:
      return op >= GRADUS_OP_MAPPING && op <= GRADUS_OP_NORMAL_DOT && op != GRADUS_OP_VECTOR_TRANSFORM &&
             op != GRADUS_OP_LIGHT_FALLOFF;
  }
}

}  // namespace gradus::shading
