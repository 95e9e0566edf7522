// Evaluation of the operations that compute values. Each operation has a function NAME_op with the formulas of the
// Cycles node of that name, which op_functions.h declares and op_table.cpp chooses; both are generated from
// schema/nodes.toml.
#pragma once

#include <string>

#include "base/types.h"
#include "gradus/gradus_nodes.h"

namespace gradus::shading {

struct ShadeContext;  // shading/context.h
struct TextureMap;    // shading/texture_extent.h

// Arguments of a pure operation, whose result depends on its inputs alone. Scalar inputs are the first component of a
// Vec4.
struct OpArgs {
  uint32_t mode = 0;
  const Vec4* in = nullptr;  // one for each input of the operation
  const float* floats = nullptr;
  uint32_t float_count = 0;
  float f(int i) const { return in[i].x; }
  Vec3 v(int i) const { return Vec3(in[i]); }
};

// Arguments of an operation that depends on the point, the ray, the object or an image.
struct ResourceArgs : OpArgs {
  uint32_t resource = 0;                    // index of the image
  const std::string* name = nullptr;        // name of an attribute; null if none is given
  const TextureMap* texture_map = nullptr;  // of an image that may be averaged; null for others
};

// Evaluate `op` and write all its outputs to `out`. Each returns false if `op` is not of its kind (op_info.h).
bool evaluate_pure(uint32_t op, const OpArgs& args, Vec4* out);
bool evaluate_context(uint32_t op, const ResourceArgs& args, const ShadeContext& context, Vec4* out);

// Return the four floats of a scalar and of a vector or colour.
inline Vec4 splat(float x) { return Vec4(x); }
inline Vec4 value(const Vec3& v) { return Vec4(v, 1.0f); }

}  // namespace gradus::shading
