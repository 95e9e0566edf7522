// Panoramic projections: between directions and points of the film, in the coordinates that each projection has there.
//
// The camera's window is measured in these coordinates (gradus.h, GradusCamera), so that sensor, limits and shift are
// all part of it. Directions are in camera space, which looks along -z, y up. The formulae are those of Cycles
// (kernel/camera/projection.h).
#pragma once

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::camera {

// False where the film sees nothing: outside of the image circle. The direction has unit length.
bool panorama_direction(const GradusCamera& camera, const Vec2& point, Vec3* direction);

// The inverse. False for directions that the projection does not show, whatever the window. Longitudes are in [-π, π].
bool panorama_point(const GradusCamera& camera, const Vec3& direction, Vec2* point);

// Whether x is an angle that comes back to the same direction after a full turn.
bool panorama_wraps(const GradusCamera& camera);

// The axes of the lens for a direction: u and v span the plane across it.
void panorama_lens_axes(const GradusCamera& camera, const Vec3& direction, Vec3* u, Vec3* v);

}  // namespace gradus::camera
