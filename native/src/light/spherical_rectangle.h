// Uniform sampling of the solid angle that a rectangle subtends at a point.
// Source: Ureña, Fajardo and King, "An Area-Preserving Parametrization for Spherical Rectangles" (EGSR 2013).
#pragma once

#include "base/types.h"

namespace gradus::light {

class SphericalRectangle {
 public:
  // The axes are orthonormal; `from` is the point from which the rectangle is seen.
  SphericalRectangle(const Vec3& centre, const Vec3& axis_x, const Vec3& axis_y, float half_width, float half_height,
                     const Vec3& from);
  // Minimum usable solid angle in steradians. For smaller ones, sampling in solid angle suffers from cancellation in
  // single precision, and sampling by area is equally good.
  static constexpr float kSmallestSolidAngle = 1e-3f;
  bool usable() const { return solid_angle_ > kSmallestSolidAngle; }
  float solid_angle() const { return solid_angle_; }
  // Returns the solid angle in which sample() is uniform; 0 if it is not usable.
  float sampled_solid_angle() const { return usable() ? solid_angle_ : 0.0f; }
  // Returns a position on the rectangle, for u in [0, 1)².
  Vec3 sample(const Vec2& u) const;

 private:
  Vec3 from_, x_, y_, z_;
  float x0_, x1_, y0_, y1_, z0_;
  float solid_angle_ = 0.0f;
};

}  // namespace gradus::light
