// A rectangle as seen from a point: uniform sampling of its solid angle.
// Ureña, Fajardo and King, "An Area-Preserving Parametrization for Spherical Rectangles" (EGSR 2013).
#pragma once

#include "base/types.h"

namespace gradus::light {

class SphericalRectangle {
 public:
  // axis_x, axis_y: unit, at right angles.
  SphericalRectangle(const Vec3& centre, const Vec3& axis_x, const Vec3& axis_y, float half_width, float half_height,
                     const Vec3& from);
  // The sampling of small solid angles cancels in float, and there sampling by area is as good.
  static constexpr float kSmallestSolidAngle = 1e-3f;
  bool usable() const { return solid_angle_ > kSmallestSolidAngle; }
  float solid_angle() const { return solid_angle_; }
  // In which sample() is uniform; 0: not usable.
  float sampled_solid_angle() const { return usable() ? solid_angle_ : 0.0f; }
  // Position on the rectangle.
  Vec3 sample(const Vec2& u) const;

 private:
  Vec3 from_, x_, y_, z_;
  float x0_, x1_, y0_, y1_, z0_;
  float solid_angle_ = 0.0f;
};

}  // namespace gradus::light
