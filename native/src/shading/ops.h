// Pure operations, whose result depends on their inputs alone. There is one function for each node, with the formulas
// of the Cycles node of that name.
#pragma once

#include "base/types.h"
#include "gradus/gradus_nodes.h"

namespace gradus::shading {

// Arguments of an operation. Scalar inputs are the first component of a Vec4.
struct OpArgs {
  uint32_t mode = 0;
  const Vec4* in = nullptr;  // one for each input of the operation
  const float* floats = nullptr;
  uint32_t float_count = 0;
  float f(int i) const { return in[i].x; }
  Vec3 v(int i) const { return Vec3(in[i]); }
};

// Evaluates `op` and writes all its outputs to `out`. Returns false if `op` is not pure.
bool evaluate_pure(uint32_t op, const OpArgs& args, Vec4* out);
bool is_pure(uint32_t op);

inline Vec4 splat(float x) { return Vec4(x); }
inline Vec4 value(const Vec3& v) { return Vec4(v, 1.0f); }

// math_ops.cpp
float math(uint32_t mode, float a, float b, float c);
Vec4 clamp_op(const OpArgs& args);
Vec4 map_range(const OpArgs& args);
// vector_math.cpp
void vector_math(const OpArgs& args, Vec4* out);
// vector_ops.cpp
Vec4 mapping(const OpArgs& args);
Vec4 vector_rotate(const OpArgs& args);
// mix_color.cpp
Vec4 mix_color(const OpArgs& args);
// color_ops.cpp
void separate(const OpArgs& args, Vec4* out);
Vec4 combine(const OpArgs& args);
Vec4 hue_saturation(const OpArgs& args);
Vec4 gamma_op(const OpArgs& args);
Vec4 invert(const OpArgs& args);
Vec4 bright_contrast(const OpArgs& args);
// blackbody.cpp: returns the linear Rec. 709 colour with luminance 1
Rgb blackbody(float kelvin);
// table_ops.cpp
void ramp(const OpArgs& args, Vec4* out);
Vec4 curves(const OpArgs& args);
// noise_ops.cpp
void noise_op(const OpArgs& args, Vec4* out);
void white_noise(const OpArgs& args, Vec4* out);
// pattern_ops.cpp
void checker(const OpArgs& args, Vec4* out);
Vec4 gradient(const OpArgs& args);
Vec4 wave(const OpArgs& args);
void magic(const OpArgs& args, Vec4* out);
void brick(const OpArgs& args, Vec4* out);

}  // namespace gradus::shading
