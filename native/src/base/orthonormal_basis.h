// Orthonormal bases around a unit vector.
#pragma once

#include <cmath>

#include "base/types.h"

namespace gradus {

// Writes two unit vectors that form a right-handed orthonormal basis (x, y, n) with the unit vector `n` (Duff et al.,
// "Building an Orthonormal Basis, Revisited", JCGT 2017).
inline void orthonormal_basis(const Vec3& n, Vec3* x, Vec3* y) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  *x = Vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
  *y = Vec3(b, sign + n.y * n.y * a, -n.y);
}

}  // namespace gradus
