// A bounding box with a conservative intersection test: it may report a hit where there is none, but misses none.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace gradus::geometry {

// An axis-aligned bounding box; empty until something is added.
struct RayBox {
  Vec3 lower{kInfinity}, upper{-kInfinity};

  // Enlarges the box so that it contains the box from a to b.
  void add(const Vec3& a, const Vec3& b) {
    lower = glm::min(lower, a);
    upper = glm::max(upper, b);
  }
  // Enlarges the box by a margin for the rounding errors of may_meet() and of the traversal of the contents.
  void widen() {
    const Vec3 margin = (glm::max(glm::abs(lower), glm::abs(upper)) + (upper - lower)) * 1e-5f;
    lower -= margin;
    upper += margin;
  }

  // Returns false if the segment t_min..t_max of a ray certainly misses the box.
  bool may_meet(const Vec3& origin, const Vec3& direction, float t_min, float t_max) const {
    for (int i = 0; i < 3; ++i) {
      const float inverse =
          1.0f / (std::fabs(direction[i]) < kTiny ? std::copysign(kTiny, direction[i]) : direction[i]);
      const float a = (lower[i] - origin[i]) * inverse, b = (upper[i] - origin[i]) * inverse;
      t_min = std::max(t_min, std::min(a, b) * (1.0f - kRounding));
      t_max = std::min(t_max, std::max(a, b) * (1.0f + kRounding));
    }
    return t_min <= t_max;
  }

 private:
  static constexpr float kTiny = 1e-18f, kRounding = 1e-6f;
};

}  // namespace gradus::geometry
