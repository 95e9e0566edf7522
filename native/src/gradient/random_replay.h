// Random replay: the shift of an event of class D that is followed by a short edge.
//
// The offset samples its direction with the random numbers of the base and traces a ray of its own. These numbers are
// the coordinates of the path, so the map is the identity, and J·pdf'/pdf = P'/P with the probabilities of the class.
// Over short edges a reconnection has an unbounded Jacobian and unbounded cosines (footprint.h).
#pragma once

#include "gradient/base_path.h"
#include "gradient/offset_path.h"
#include "gradient/shifted_event.h"

namespace gradus::gradient {

// Samples the event at y with the random numbers u that produced `event` at x. Fails if the class, kind or side of the
// two events differs.
ShiftedEvent replay_event(const path::Vertex& x, const path::ScatterEvent& event, const path::VertexSample& u,
                          const path::Vertex& y);

// Returns whether an event of class D at x or y that is followed by a vertex z is replayed: z must have class D. If z
// is specular only, the direction is copied, and the inverse shift may do the same.
bool replays(const Vec3& x, const Vec3& y, const path::Vertex& z);

// Replays the base's last event at a pending offset, and couples the offset's next vertex to `z`, the base's vertex.
// Fails if the inverse shift would not be a replay.
ShiftFailure replay(const BasePath& base, const path::Vertex& z, OffsetPath* offset, film::Counters* counters);

}  // namespace gradus::gradient
