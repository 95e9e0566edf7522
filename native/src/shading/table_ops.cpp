// The Color Ramp and Curves nodes: look-ups in tables that the host has sampled.
#include "shading/op_functions.h"
#include "shading/scalar.h"

namespace gradus::shading {
namespace {

// Interpolates a table of `count` rows of `stride` floats at `x` in 0…1. Outside that range it continues the line
// through the outermost two rows if `extrapolate`, else it clamps.
float lookup(const float* table, int count, int stride, float x, bool extrapolate) {
  const float last = static_cast<float>(count - 1);
  const auto at = [&](int i) { return table[i * stride]; };
  if (extrapolate && x < 0.0f) return at(0) + (at(0) - at(1)) * -x * last;
  if (extrapolate && x > 1.0f) return at(count - 1) + (at(count - 1) - at(count - 2)) * (x - 1.0f) * last;
  const float position = saturate(x) * last;
  const int i = std::min(static_cast<int>(position), count - 2);
  const float t = position - static_cast<float>(i);
  return at(i) * (1.0f - t) + at(i + 1) * t;
}

}  // namespace

void ramp_op(const OpArgs& args, Vec4* out) {
  const int count = static_cast<int>(args.float_count / 4);
  const float position = saturate(args.f(0)) * static_cast<float>(count - 1);
  const int i = std::clamp(static_cast<int>(position), 0, count - 1);
  const float t = args.mode & 1 ? 0.0f : position - static_cast<float>(i);
  const int next = std::min(i + 1, count - 1);
  for (int c = 0; c < 4; c++) out[0][c] = args.floats[i * 4 + c] * (1.0f - t) + args.floats[next * 4 + c] * t;
  out[1] = splat(out[0].w);
}

void curves_op(const OpArgs& args, Vec4* out) {
  const int channels = args.mode == GRADUS_CURVES_FLOAT ? 1 : 3;
  const int count = (static_cast<int>(args.float_count) - 3) / channels;
  const float lower = args.floats[0], range = args.floats[1] - lower;
  const bool extrapolate = args.floats[2] != 0.0f;
  const Vec4 in = args.in[1];
  Vec4 mapped(0.0f, 0.0f, 0.0f, 1.0f);
  for (int c = 0; c < channels; c++)
    mapped[c] = lookup(args.floats + 3 + c, count, channels, safe_divide(in[c] - lower, range), extrapolate);
  if (channels == 1) mapped = splat(mapped.x);
  out[0] = in + (mapped - in) * args.f(0);
}

}  // namespace gradus::shading
