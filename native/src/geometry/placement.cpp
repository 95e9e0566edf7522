#include "geometry/placement.h"

namespace gradus::geometry {

Placement make_placement(const glm::dmat4& m) {
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(m));
  Placement p;
  p.to_world = Mat4(m);
  p.to_local = Mat4(glm::dmat4(inverse));
  p.to_local[3] = Vec4(Vec3(-(inverse * glm::dvec3(m[3]))), 1.0f);
  p.normal_to_world = Mat3(glm::transpose(inverse));
  return p;
}

}  // namespace gradus::geometry
