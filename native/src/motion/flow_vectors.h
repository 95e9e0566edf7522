// The vectors from one frame to another: the surfaces' motion, and what optical flow finds beside it.
#pragma once

#include "motion/flow_frame.h"

namespace gradus::motion {

// By pixels of `from`. Finite, no longer than the film. Throws as optical_flow().
std::vector<Vec2> flow_vectors(const FlowLibrary& library, const FlowFrame& from, const FlowFrame& to);

}  // namespace gradus::motion
