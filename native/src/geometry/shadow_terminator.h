// Origins of shadow rays on faceted meshes with smooth normals. The terminator is the line between the lit and the
// unlit side of an object. Facets make it a sequence of steps, although the smooth surface that they approximate
// darkens gradually. Near the terminator, shadow rays therefore begin on a bulged surface instead of the facet. This is
// Cycles' heuristic (kernel/light/sample.h) of the object setting Shadow Terminator > Geometry Offset, after Hanika,
// "Hacking the Shadow Terminator" (Ray Tracing Gems II, chapter 4).
//
// Only light sampling uses the bulge. Rays that a BSDF has sampled leave from the facet, so that the two techniques see
// different light near the terminator.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/geometry.h"

namespace gradus::geometry {

// Returns the share of the bulge's height, 0 to 1, that is used for a light in this direction. It is 1 at the
// terminator. It is 0 if the cosines to both normals exceed the point's setting.
inline float terminator_share(const SurfacePoint& point, const Vec3& direction) {
  const float cutoff = point.shadow_terminator_offset;
  if (!(cutoff > 0.0f)) return 0.0f;
  const float smooth = glm::dot(point.shading_normal, direction);
  const float facet = std::copysign(1.0f, smooth) * glm::dot(point.geometric_normal, direction);
  const float from = std::fabs(smooth) < cutoff ? 2.0f - (facet + std::fabs(smooth)) / cutoff : 1.0f - facet / cutoff;
  return std::clamp(from, 0.0f, 1.0f);
}

// Returns whether shadow rays in this direction leave from the facet itself. Light samples and BSDF samples see the
// same light then.
inline bool leaves_facet(const SurfacePoint& point, const Vec3& direction) {
  return terminator_share(point, direction) == 0.0f;
}

// Returns the origin of a shadow ray towards a light in this direction.
Vec3 shadow_origin(const Geometry& geometry, const SurfacePoint& point, const Vec3& direction);

}  // namespace gradus::geometry
