// Stereo for panoramas: the two eyes lie on a circle about the camera, wherever one looks. As in Cycles.
#pragma once

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::camera {

// Of a ray that leaves the camera's centre: moves it to the eye, to the right of its direction. up: axis of the circle.
void move_to_eye(const GradusCamera& camera, const Vec3& up, Vec3* origin, Vec3* direction);

// The direction from the centre whose ray, moved to the eye, goes through a point (relative to the centre), or at
// infinity along it.
bool direction_from_centre(const GradusCamera& camera, const Vec3& up, const Vec3& point, bool at_infinity,
                           Vec3* direction);

}  // namespace gradus::camera
