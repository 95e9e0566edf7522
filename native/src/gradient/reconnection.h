// Reconnection: an offset path joins its base at the base's next vertex (thesis 5.4.2, step 3).
#pragma once

#include "geometry/surface.h"
#include "gradient/half_vector.h"

namespace gradus::gradient {

struct Reconnection {
  Vec3 direction = Vec3(0.0f);  // from the offset vertex to the shared one
  float distance = 0.0f;
  float jacobian = 0.0f;  // |∂ω'/∂ω|: solid angle at the offset vertex over that at the base vertex
  ShiftFailure failure = ShiftFailure::None;
};

// Both vertices see the same area dA at `target`: dω = |cosθ|/d² dA, so J = (|cosθ'|/d'²) / (|cosθ|/d²) with the
// geometric normal of the target. Inverse: base and offset exchanged.
Reconnection reconnect(const Vec3& base, const Vec3& offset, const Vec3& target, const Vec3& target_normal);

// Parallax is about the angle between the paths from x and y to z: |x − y|, the footprint of a pixel's ray where the
// paths stand, over the shorter edge. Symmetric in x and y, and so is what follows.
bool is_parallax_below(const Vec3& x, const Vec3& y, const Vec3& z, float angle);

// Edges shorter than the footprint are not connected: Jacobians and cosines are of any size there.
bool is_short_edge(const Vec3& x, const Vec3& y, const Vec3& z);

// Class D before a sharp event at z: whether the paths from x and y share z, where the event is copied and their rays
// part, or keep their direction and meet the sharp surface at two places. Behind it their directions differ by about
// the parallax in the first case, by 2 |x − y| times the curvature in the second. So curved surfaces are shared; flat
// ones, which leave parallel rays parallel, where that costs little (sharing never misses a mirror beyond its rim), but
// not flat panes, behind which most often lies the distance. Never over short edges.
bool shares_sharp_vertex(const Vec3& x, const Vec3& y, const Vec3& z, float curvature, bool transmission);

// Whether a lobe of this width (alpha) at z looks much the same from x and y, so that the event need not be copied: its
// direction is shared, too.
bool looks_similar(const Vec3& x, const Vec3& y, const Vec3& z, float width);

// Jacobian of copying an emitter point, in solid angle at the receivers; 1 at infinity, where the direction is copied,
// and for Dirac emitters, whose choice is discrete.
float light_point_jacobian(float cosine_base, float distance_base, float cosine_offset, float distance_offset);

}  // namespace gradus::gradient
