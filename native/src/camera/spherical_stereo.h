// Spherical stereo, as in Cycles. For every view direction, the two eyes lie on a circle around the camera's centre.
#pragma once

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::camera {

// Moves a ray from the camera's centre to the eye, which lies to the right of the ray's direction. `up` is the axis of
// the circle.
void move_to_eye(const GradusCamera& camera, const Vec3& up, Vec3* origin, Vec3* direction);

// Computes the direction from the centre whose ray, moved to the eye, goes through `point` (relative to the centre), or
// is parallel to it if `at_infinity` is true. Returns false if there is none.
bool direction_from_centre(const GradusCamera& camera, const Vec3& up, const Vec3& point, bool at_infinity,
                           Vec3* direction);

}  // namespace gradus::camera
