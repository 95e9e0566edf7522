// Panoramic projections between directions and points on the film, which are in the coordinates of each projection
// (for example longitude and latitude).
//
// The camera's window is measured in these coordinates (gradus.h, GradusCamera), so that it
// includes sensor size, limits and shift. Directions are in camera space, which looks along -z, y up. The formulae are
// those of Cycles (kernel/camera/projection.h).
#pragma once

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::camera {

// Computes the unit direction of a film point. Returns false where the film shows nothing, which is outside of the
// image circle.
bool panorama_direction(const GradusCamera& camera, const Vec2& point, Vec3* direction);

// Computes the film point of a unit direction. Returns false if the projection does not show the direction with any
// window. Longitudes are in [-π, π].
bool panorama_point(const GradusCamera& camera, const Vec3& direction, Vec2* point);

// Returns whether x is an angle, so that a full turn gives the same direction.
bool panorama_wraps(const GradusCamera& camera);

// Computes the lens axes u and v, which span the plane perpendicular to the direction.
void panorama_lens_axes(const GradusCamera& camera, const Vec3& direction, Vec3* u, Vec3* v);

}  // namespace gradus::camera
