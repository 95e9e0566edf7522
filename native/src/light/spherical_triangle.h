// Uniform sampling of the solid angle that a triangle subtends at a point.
// Source: Arvo, "Stratified Sampling of Spherical Triangles" (SIGGRAPH 1995), in a form that avoids cancellation for
// small triangles.
#pragma once

#include <array>

#include "base/types.h"

namespace gradus::light {

class SphericalTriangle {
 public:
  SphericalTriangle(const std::array<Vec3, 3>& corners, const Vec3& from);
  // Returns whether sample() is accurate. For small solid angles, sampling by area is equally good. For solid angles
  // near a hemisphere, the point lies almost in the triangle's plane.
  bool usable() const { return solid_angle_ > 1e-3f && solid_angle_ < 6.2f; }
  float solid_angle() const { return solid_angle_; }
  // Returns the solid angle in which sample() is uniform; 0 if it is not usable.
  float sampled_solid_angle() const { return usable() ? solid_angle_ : 0.0f; }
  // Returns a unit direction from the point towards the triangle, for u in [0, 1)².
  Vec3 sample(const Vec2& u) const;

 private:
  Vec3 a_, b_, c_;  // Unit directions from the point to the corners.
  float volume_;    // |a·(b × c)|
  float solid_angle_;
};

// Returns the barycentric weights of the second and third corner where the line from a point along a direction meets
// the triangle. They are clamped to the triangle, in case rounding moves the intersection outside.
Vec2 barycentric_towards(const std::array<Vec3, 3>& corners, const Vec3& from, const Vec3& direction);

}  // namespace gradus::light
