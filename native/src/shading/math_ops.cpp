// The Math, Clamp and Map Range nodes.
#include <cfloat>

#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Cubic polynomial smooth minimum (Quilez).
float smooth_min(float a, float b, float k) {
  if (k == 0.0f) return std::min(a, b);
  const float h = std::max(k - std::fabs(a - b), 0.0f) / k;
  return std::min(a, b) - h * h * h * k * (1.0f / 6.0f);
}

float pingpong(float a, float b) { return b != 0.0f ? std::fabs(fraction((a - b) / (b * 2.0f)) * b * 2.0f - b) : 0.0f; }

float logarithm(float a, float base) {
  if (a <= 0.0f || base <= 0.0f) return 0.0f;
  return safe_divide(std::log(a), std::log(base));
}

float trigonometry(uint32_t mode, float a, float b) {
  switch (mode) {
    case GRADUS_MATH_SINE:
      return std::sin(a);
    case GRADUS_MATH_COSINE:
      return std::cos(a);
    case GRADUS_MATH_TANGENT:
      return std::tan(a);
    case GRADUS_MATH_ARCSINE:
      return std::asin(std::clamp(a, -1.0f, 1.0f));
    case GRADUS_MATH_ARCCOSINE:
      return std::acos(std::clamp(a, -1.0f, 1.0f));
    case GRADUS_MATH_ARCTANGENT:
      return std::atan(a);
    case GRADUS_MATH_ARCTAN2:
      return std::atan2(a, b);
    case GRADUS_MATH_SINH:
      return std::sinh(a);
    case GRADUS_MATH_COSH:
      return std::cosh(a);
    case GRADUS_MATH_TANH:
      return std::tanh(a);
    case GRADUS_MATH_RADIANS:
      return a * (kPi / 180.0f);
    case GRADUS_MATH_DEGREES:
      return a * (180.0f / kPi);
    default:
      return 0.0f;
  }
}

float rounding(uint32_t mode, float a, float b, float c) {
  switch (mode) {
    case GRADUS_MATH_ROUND:
      return std::floor(a + 0.5f);
    case GRADUS_MATH_FLOOR:
      return std::floor(a);
    case GRADUS_MATH_CEIL:
      return std::ceil(a);
    case GRADUS_MATH_TRUNC:
      return std::trunc(a);
    case GRADUS_MATH_FRACT:
      return fraction(a);
    case GRADUS_MATH_MODULO:
      return safe_modulo(a, b);
    case GRADUS_MATH_FLOORED_MODULO:
      return b != 0.0f ? a - std::floor(a / b) * b : 0.0f;
    case GRADUS_MATH_WRAP:
      return wrap(a, b, c);
    case GRADUS_MATH_SNAP:
      return snap(a, b);
    case GRADUS_MATH_PINGPONG:
      return pingpong(a, b);
    default:
      return trigonometry(mode, a, b);
  }
}

float clamp_one(float x, float lower, float upper, bool range) {
  if (range && lower > upper) std::swap(lower, upper);
  return std::min(std::max(x, lower), upper);
}

// Maps component `i` of the vector of a Map Range node.
float map_one(uint32_t mode, const OpArgs& args, int i) {
  const float x = args.in[0][i], from0 = args.in[1][i], from1 = args.in[2][i], to0 = args.in[3][i], to1 = args.in[4][i];
  // The float and the vector version of Cycles' node differ for an empty range.
  if (from0 == from1) return args.mode & 16 ? to0 : 0.0f;
  float t = safe_divide(x - from0, from1 - from0);
  if (mode == GRADUS_MAP_RANGE_STEPPED)
    t = args.in[5][i] > 0.0f ? std::floor(t * (args.in[5][i] + 1.0f)) / args.in[5][i] : 0.0f;
  if (mode == GRADUS_MAP_RANGE_SMOOTHSTEP)
    t = from0 > from1 ? 1.0f - smoothstep(from1, from0, x) : smoothstep(from0, from1, x);
  if (mode == GRADUS_MAP_RANGE_SMOOTHERSTEP)
    t = from0 > from1 ? 1.0f - smootherstep(from1, from0, x) : smootherstep(from0, from1, x);
  return to0 + t * (to1 - to0);
}

float math(uint32_t mode, float a, float b, float c) {
  switch (mode) {
    case GRADUS_MATH_ADD:
      return a + b;
    case GRADUS_MATH_SUBTRACT:
      return a - b;
    case GRADUS_MATH_MULTIPLY:
      return a * b;
    case GRADUS_MATH_DIVIDE:
      return safe_divide(a, b);
    case GRADUS_MATH_MULTIPLY_ADD:
      return a * b + c;
    case GRADUS_MATH_POWER:
      return safe_power(a, b);
    case GRADUS_MATH_LOGARITHM:
      return logarithm(a, b);
    case GRADUS_MATH_SQRT:
      return std::sqrt(std::max(a, 0.0f));
    case GRADUS_MATH_INVERSE_SQRT:
      return a > 0.0f ? 1.0f / std::sqrt(a) : 0.0f;
    case GRADUS_MATH_ABSOLUTE:
      return std::fabs(a);
    case GRADUS_MATH_EXPONENT:
      return std::exp(a);
    case GRADUS_MATH_MINIMUM:
      return std::min(a, b);
    case GRADUS_MATH_MAXIMUM:
      return std::max(a, b);
    case GRADUS_MATH_LESS_THAN:
      return a < b ? 1.0f : 0.0f;
    case GRADUS_MATH_GREATER_THAN:
      return a > b ? 1.0f : 0.0f;
    case GRADUS_MATH_SIGN:
      return sign(a);
    case GRADUS_MATH_COMPARE:
      return a == b || std::fabs(a - b) <= std::max(c, FLT_EPSILON) ? 1.0f : 0.0f;
    case GRADUS_MATH_SMOOTH_MIN:
      return smooth_min(a, b, c);
    case GRADUS_MATH_SMOOTH_MAX:
      return -smooth_min(-a, -b, c);
    default:
      return rounding(mode, a, b, c);
  }
}

}  // namespace

void math_op(const OpArgs& args, Vec4* out) {
  const float r = math(args.mode & 63, args.f(0), args.f(1), args.f(2));
  out[0] = splat(args.mode & 64 ? std::min(std::max(r, 0.0f), 1.0f) : r);
}

void clamp_op(const OpArgs& args, Vec4* out) {
  for (int i = 0; i < 4; i++) out[0][i] = clamp_one(args.in[0][i], args.in[1][i], args.in[2][i], args.mode == 1);
}

void map_range_op(const OpArgs& args, Vec4* out) {
  const uint32_t mode = args.mode & 7;
  Vec4 r;
  for (int i = 0; i < 4; i++) {
    r[i] = map_one(mode, args, i);
    if (args.mode & 8) r[i] = clamp_one(r[i], args.in[3][i], args.in[4][i], true);
  }
  out[0] = r;
}

}  // namespace gradus::shading
