// What node programs read of an object: of an instance of a mesh, or of a light.
#pragma once

#include <vector>

#include "geometry/placement.h"

namespace gradus::geometry {

struct ObjectData : Placement {
  uint32_t random_id = 0;  // node Object Info reads it as a fraction of 2^32
  int32_t pass_index = 0;
  Vec4 color{1.0f};
  Vec3 generated{0.0f};  // where its instancer has it
  Vec2 uv{0.0f};
  std::vector<Vec4> attributes;  // in the order of Geometry::instance_attribute_names
};

}  // namespace gradus::geometry
