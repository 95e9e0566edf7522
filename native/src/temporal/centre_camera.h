// The camera as pixel centres see through it: at rest where it is at the moment of the frame, with a point for a lens.
#pragma once

#include "scene/camera.h"
#include "scene/snapshot.h"

namespace gradus {

Camera centre_camera(const Snapshot& snapshot, uint32_t width, uint32_t height);

}  // namespace gradus
