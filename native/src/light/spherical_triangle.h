// A triangle as seen from a point: uniform sampling of its solid angle.
// Arvo, "Stratified Sampling of Spherical Triangles" (SIGGRAPH 1995), in a form that keeps its digits for small
// triangles.
#pragma once

#include <array>

#include "base/types.h"

namespace gradus::light {

class SphericalTriangle {
 public:
  SphericalTriangle(const std::array<Vec3, 3>& corners, const Vec3& from);
  // Small solid angles are as well sampled by area; near a half space the point lies almost in the triangle's plane.
  bool usable() const { return solid_angle_ > 1e-3f && solid_angle_ < 6.2f; }
  float solid_angle() const { return solid_angle_; }
  // In which sample() is uniform; 0: not usable.
  float sampled_solid_angle() const { return usable() ? solid_angle_ : 0.0f; }
  // Unit direction from the point.
  Vec3 sample(const Vec2& u) const;

 private:
  Vec3 a_, b_, c_;  // unit, towards the corners
  float volume_;    // |a·(b × c)|
  float solid_angle_;
};

// Weights of the 2nd and 3rd corner where a line from a point meets the triangle, moved to the triangle where rounding
// left it.
Vec2 barycentric_towards(const std::array<Vec3, 3>& corners, const Vec3& from, const Vec3& direction);

}  // namespace gradus::light
