// The matrix of an object, with its inverse and the matrix of its normals.
#pragma once

#include "base/types.h"

namespace gradus::geometry {

// Transformations between an object's local space and the snapshot's internal space. "World" in the names means
// internal space here: true world coordinates differ from it by the snapshot's origin.
struct Placement {
  Mat4 to_world{1.0f};
  Mat4 to_local{1.0f};
  Mat3 normal_to_world{1.0f};  // inverse transpose; outward normals stay outward if mirrored
};

// Computes the placement of an object from its affine, invertible matrix `m` to internal space.
Placement make_placement(const glm::dmat4& m);

}  // namespace gradus::geometry
