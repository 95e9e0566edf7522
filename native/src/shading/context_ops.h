// Operations that depend on the point, the ray, the object or an image. Each is the Cycles node of that name.
#pragma once

#include "shading/context.h"
#include "shading/ops.h"

namespace gradus::shading {

// Arguments of an operation with an image or a name.
struct ResourceArgs : OpArgs {
  uint32_t resource = 0;              // index of the image
  const std::string* name = nullptr;  // name of an attribute; null if none is given
};

// Evaluates `op` and writes all its outputs to `out`. Returns false if `op` is not an operation of this file.
bool evaluate_context_op(uint32_t op, const ResourceArgs& args, const ShadeContext& context, Vec4* out);

// geometry_ops.cpp
Vec3 geometry(uint32_t mode, const ShadeContext& context);
Vec3 default_tangent(const ShadeContext& context);
Vec3 generated(const ShadeContext& context);
// texture_coordinate_ops.cpp
Vec3 texture_coordinate(const ResourceArgs& args, const ShadeContext& context);
Vec3 to_camera(const ShadeContext& context, const Vec3& world_position);
void camera_data(const ShadeContext& context, Vec4* out);
Vec3 vector_transform(const OpArgs& args, const ShadeContext& context);
// attribute_ops.cpp
Vec4 attribute_value(const ShadeContext& context, const std::string* name, bool uv, uint32_t* channels);
void attribute(const ResourceArgs& args, const ShadeContext& context, Vec4* out);
void object_info(const ShadeContext& context, Vec4* out);
// tangent_ops.cpp
Vec3 tangent(const ResourceArgs& args, const ShadeContext& context);
Vec3 normal_map(const ResourceArgs& args, const ShadeContext& context);
// ray_ops.cpp
float light_path(uint32_t mode, const ShadeContext& context);
void layer_weight(const OpArgs& args, const ShadeContext& context, Vec4* out);
float fresnel(const OpArgs& args, const ShadeContext& context);
float light_falloff(const OpArgs& args, const ShadeContext& context);
// image_ops.cpp
void image(const ResourceArgs& args, const ShadeContext& context, Vec4* out);
Vec4 environment(const ResourceArgs& args, const ShadeContext& context);

}  // namespace gradus::shading
