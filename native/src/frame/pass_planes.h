// The planes of data and light passes that an integrator fills.
#pragma once

#include "frame/frame.h"

namespace gradus {

// Zeroed, in order of pass number. passes: what is asked for; pixels: of the frame's region.
std::vector<PassPlane> make_pass_planes(uint64_t passes, size_t pixels);

}  // namespace gradus
