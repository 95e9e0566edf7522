// What a host does for a frame, through the C API, as one call: scene, commit, render, passes; everything is released
// whatever fails.
#pragma once

#include <vector>

#include "api/test_scene.h"

namespace gradus::memory {

// Without the stats: nlohmann::json 3.11 needs memory in its destructors, which may not throw.
//
// The first code that is not OK, or OK; `image`: Combined.
GradusError render_once(GradusDevice device, uint32_t integrator, std::vector<float>* image);

}  // namespace gradus::memory
