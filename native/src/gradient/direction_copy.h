// Direction copy: the shift of an event of class D before a specular event, where base and offset do not meet at the
// specular surface. The offset scatters in the base's direction and traces a ray of its own, so J = 1 in solid angle.
#pragma once

#include "gradient/base_path.h"
#include "gradient/offset_path.h"
#include "gradient/shifted_event.h"

namespace gradus::gradient {

// Returns whether the base's last event and that at y share the specular vertex z, at which the path scatters in class
// `next` (footprint.h).
bool shares_vertex(const BasePath& base, const Vec3& y, const path::Vertex& z, bsdf::ScatterClass next);
// Returns whether the lobe of the specular event at z looks alike from the base's vertex and from y, so that both paths
// share z and the direction behind it.
bool shares_direction(const BasePath& base, const Vec3& y, const path::Vertex& z, const path::ScatterEvent& event);

// Copies the base's last direction to a pending offset, and couples the vertex that it finds to the base's vertex, at
// which the base scatters by `next`. Fails if the inverse shift would share a vertex.
ShiftFailure copy_direction(const BasePath& base, const path::ScatterEvent& next, OffsetPath* offset,
                            film::Counters* counters);

}  // namespace gradus::gradient
