// Where an object stands: its matrix with what is worked out from it.
#pragma once

#include "base/types.h"

namespace gradus::geometry {

// Matrices lead to and from the snapshot's internal space (Snapshot::origin).
struct Placement {
  Mat4 to_world{1.0f};
  Mat4 to_local{1.0f};
  Mat3 normal_to_world{1.0f};  // inverse transpose: a mirrored object keeps outside outside
};

// m: affine, with an inverse.
Placement make_placement(const glm::dmat4& m);

}  // namespace gradus::geometry
