// Motion vectors from one frame to another: the motion of surfaces plus what optical flow finds relative to it.
#pragma once

#include "motion/flow_frame.h"

namespace gradus::motion {

// Returns a vector in pixels for each pixel of `from`. Vectors are finite and no longer than the film. Throws as
// optical_flow() does.
std::vector<Vec2> flow_vectors(const FlowLibrary& library, const FlowFrame& from, const FlowFrame& to);

}  // namespace gradus::motion
