// The shift of an event of class Subsurface: random replay.
//
// The offset enters at its own vertex and walks with the random numbers of the base. These numbers are the coordinates
// of the path, also where the two walks take different numbers of steps, because the numbers that only one of them uses
// are free. So the map is the identity, and J·pdf'/pdf = P'/P with the probabilities of the class. The walks of
// neighbours stay close together on smooth surfaces. Where one of the two walks is lost, the other one is unpaired.
#pragma once

#include "gradient/base_path.h"
#include "gradient/offset_path.h"
#include "gradient/shifted_event.h"

namespace gradus::gradient {

// Replays the base's walk from `entry` at a coupled offset. The offset's vertex becomes that at which light leaves.
ShiftFailure replay_below(const BasePath& base, const path::Vertex& entry, OffsetPath* offset,
                          film::Counters* counters);

}  // namespace gradus::gradient
