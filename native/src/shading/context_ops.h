// What the functions of several operations read from the shaded point.
#pragma once

#include "shading/context.h"
#include "shading/op_functions.h"

namespace gradus::shading {

// Returns whether a GradusNormalSpace is one of tangents.
inline bool is_tangent_space(uint32_t space) {
  return space == GRADUS_NORMAL_TANGENT || space == GRADUS_NORMAL_UNIT_TANGENT ||
         space == GRADUS_NORMAL_BLENDED_TANGENT;
}
// Returns the tangent around the z axis of the object's generated coordinates, perpendicular to the normal. It is
// not a number on lights.
Vec3 default_tangent(const ShadeContext& context);
// Returns the position in the space of the object, or in world space without one.
Vec3 local_position(const ShadeContext& context);
// Returns the generated coordinates, or local_position() without a surface.
Vec3 generated(const ShadeContext& context);
// Returns the interpolated tangent of a UV map, in the object's space, with its handedness in w. It is 0 if the mesh
// has no usable UV map. `name` may be null, for the default map.
Vec4 uv_tangent(const ShadeContext& context, const std::string* name);
// Returns an attribute of the mesh, interpolated at the hit. If `name` is null and `uv` is true it is the mesh's
// default UV map. `channels` may be null; *channels receives the number of channels, or 0 if there is no such
// attribute.
Vec4 attribute_value(const ShadeContext& context, const std::string* name, bool uv, uint32_t* channels);

}  // namespace gradus::shading
