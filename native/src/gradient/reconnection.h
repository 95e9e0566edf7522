// Reconnection: an offset path joins its base path at the base's next vertex (thesis, section 5.4.2, step 3).
#pragma once

#include "geometry/surface.h"
#include "gradient/half_vector.h"

namespace gradus::gradient {

struct Reconnection {
  Vec3 direction = Vec3(0.0f);  // unit vector from the offset vertex to the shared vertex
  float distance = 0.0f;
  float jacobian = 0.0f;  // |∂ω'/∂ω|: solid angle at the offset vertex over that at the base vertex
  ShiftFailure failure = ShiftFailure::None;
};

// Connects the offset vertex to `target`, the next vertex of the base. Base and offset see the same area dA at
// `target`: dω = |cosθ|/d² dA, so J = (|cosθ'|/d'²) / (|cosθ|/d²) with the geometric normal of the target. The inverse
// exchanges base and offset. Sets `failure` to Jacobian if J is 0 or not finite.
Reconnection reconnect(const Vec3& base, const Vec3& offset, const Vec3& target, const Vec3& target_normal);

// Returns whether the parallax of x and y at z is below `angle` in radians. The parallax is approximately the angle
// between the edges from x and y to z: |x − y|, which is the footprint of a pixel's ray at the two vertices, divided by
// the length of the shorter edge. This function and those below are symmetric in x and y.
bool is_parallax_below(const Vec3& x, const Vec3& y, const Vec3& z, float angle);

// Returns whether the shorter edge from x or y to z is shorter than the footprint |x − y|. Such edges are not
// connected, because their Jacobians and cosines are unbounded.
bool is_short_edge(const Vec3& x, const Vec3& y, const Vec3& z);

// Decides how to shift an event of class D at x and y that is followed by a sharp event at z. If it returns true, both
// paths share z; the sharp event is copied there, and their rays diverge. If it returns false, the offset copies the
// direction, and the two paths meet the sharp surface at different points. Behind z the directions differ by about the
// parallax in the first case, and by 2 |x − y| times the curvature in the second. So curved surfaces are shared. Flat
// mirrors keep parallel rays parallel, so they are shared only at low parallax, because a shared vertex never misses
// the mirror beyond its rim. Flat panes are not shared, because the surfaces behind them are usually distant. Vertices
// over short edges are never shared.
bool shares_sharp_vertex(const Vec3& x, const Vec3& y, const Vec3& z, float curvature, bool transmission);

// Returns whether a lobe of this width (alpha) at z looks about the same from x and y. If so, both paths share the
// direction of the event as well, and the event need not be copied.
bool looks_similar(const Vec3& x, const Vec3& y, const Vec3& z, float width);

// Returns the Jacobian of copying a point on a light, in solid angle at the two receivers. Callers use 1 instead for
// lights at infinity, whose direction is copied, and for Dirac lights, whose choice is discrete.
float light_point_jacobian(float cosine_base, float distance_base, float cosine_offset, float distance_offset);

}  // namespace gradus::gradient
