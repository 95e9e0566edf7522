// Segments that offset paths trace themselves, before they share those of the base.
#pragma once

#include "geometry/rays4.h"
#include "gradient/base_path.h"
#include "gradient/offset_path.h"
#include "gradient/shifted_event.h"
#include "integrator/pixel_loop.h"

namespace gradus::gradient {

// Returns the surface points of the offsets' latest vertices.
geometry::Points4 offset_points(const OffsetPaths& offsets, float time);

// Traces the camera rays of all coupled offsets, which have the base's position in the pixel, point on the lens and
// time, so that the camera's factor of r is 1. `vertices` are the camera vertices of the pixel block of `sample`.
void trace_camera_rays(const BasePath& base, const integrator::PixelSample& sample, path::CameraVertices* vertices,
                       OffsetPaths* offsets, film::Counters* counters);

// Lets the offset scatter by `event` with a ray of its own. `is_dirac` says whether the event is of a Dirac lobe.
void leave_by_event(const BasePath& base, const ShiftedEvent& event, bool is_dirac, OffsetPath* offset);
// Traces the offset's ray beside the base's current segment. `first` is its nearest hit, or null if it is unknown.
void trace_own_segment(const BasePath& base, const geometry::Hit* first, OffsetPath* offset, film::Counters* counters);
// Lets the offset scatter by `event` at class D and traces its ray to a vertex of its own. Returns why the shift fails
// if the event does not exist or the ray meets no surface.
ShiftFailure trace_to_own_vertex(const BasePath& base, const ShiftedEvent& event, OffsetPath* offset,
                                 film::Counters* counters);

}  // namespace gradus::gradient
