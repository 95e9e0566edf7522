// All calls of the C API that a host makes for a frame: scene, commit, render, passes, and release, even after errors.
#pragma once

#include <vector>

#include "api/test_scene.h"

namespace gradus::memory {

// Renders a frame of 8×8 pixels and reads its Combined pass to `image`, which must have 8 * 8 * 4 values. Returns the
// first error code that is not OK, or OK. It does not read the stats, because the destructors of nlohmann::json 3.11
// allocate memory and cannot report that they failed.
GradusError render_once(GradusDevice device, uint32_t integrator, std::vector<float>* image);

}  // namespace gradus::memory
