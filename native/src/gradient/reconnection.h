// Reconnection: the offset path joins its base path at the base's next vertex (Manzi 2016, section 5.4.2, step 3).
//
// It is the shift of events of class D at x_i and y_i whose successor x_{i+1} scatters in class D, emits light, or has
// a specular lobe that looks the same from both vertices. From x_{i+1} on both paths share all vertices. Where the
// blurs of Filter Glossy behind x_{i+1} differ, they share that vertex, its light samples and the emission on the next
// segment, and the shift ends there.
#pragma once

#include "gradient/base_path.h"
#include "gradient/offset_path.h"
#include "gradient/shifted_event.h"

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

// Returns the Jacobian of copying a point on a surface or light, in solid angle at the two receivers.
float area_jacobian(float cosine_base, float distance_base, float cosine_offset, float distance_offset);

// Connects all pending offsets that have no connection yet to `z`, the base's latest vertex. Counts shadow rays and
// failures.
void connect_pending(const BasePath& base, const path::Vertex& z, OffsetPaths* offsets, film::Counters* counters);

// Returns whether `z` faces the offset and the base with the same side, so that both can scatter there.
bool sees_same_side(const OffsetPath& offset, const path::Vertex& z);
// Returns the emission of the shared vertex `z` towards the offset. It does not evaluate closures, which may not be
// needed.
Rgb shared_emission(const BasePath& base, const OffsetPath& offset, const path::Vertex& z);
// Shades the shared vertex `z`, whose closures are known, as seen from the offset.
void shade_shared_vertex(const BasePath& base, const path::Vertex& z, OffsetPath* offset);

// Makes the offset share the path behind `z`, at which the base has scattered by `event`. Sets throughput and ratio
// behind the event, or returns why the shift fails.
ShiftFailure reconnect_at(const BasePath& base, const path::Vertex& z, const path::ScatterEvent& event,
                          OffsetPath* offset);
// Makes `z`, as seen from the offset, the offset's vertex, at which the base's event will be copied.
void share_vertex(const BasePath& base, const path::Vertex& z, OffsetPath* offset);

}  // namespace gradus::gradient
