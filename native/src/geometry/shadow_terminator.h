// Shadow rays of faceted meshes with smooth normals. Facets end the light in steps where the smooth surface that they
// stand for ends it softly. Near that line, the terminator, shadow rays begin on a bulged surface in place of the
// facet: Cycles' heuristic (kernel/light/sample.h) of the object setting Shadow Terminator > Geometry Offset, after
// Hanika, "Hacking the Shadow Terminator" (Ray Tracing Gems II, chapter 4).
//
// Light sampling alone does so: rays that a BSDF has chosen leave from the facet, so that there the two techniques see
// different light.
#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/geometry.h"

namespace gradus::geometry {

// How much of the bulge counts towards a light in this direction, 0 to 1: all of it at the terminator, none at cosines
// to both normals beyond the point's setting.
inline float terminator_share(const SurfacePoint& point, const Vec3& direction) {
  const float cutoff = point.shadow_terminator_offset;
  if (!(cutoff > 0.0f)) return 0.0f;
  const float smooth = glm::dot(point.shading_normal, direction);
  const float facet = std::copysign(1.0f, smooth) * glm::dot(point.geometric_normal, direction);
  const float from = std::fabs(smooth) < cutoff ? 2.0f - (facet + std::fabs(smooth)) / cutoff : 1.0f - facet / cutoff;
  return std::clamp(from, 0.0f, 1.0f);
}

// Light and BSDF samples leave the facet itself: in this direction they see the same.
inline bool leaves_facet(const SurfacePoint& point, const Vec3& direction) {
  return terminator_share(point, direction) == 0.0f;
}

// Where a shadow ray towards a light begins.
Vec3 shadow_origin(const Geometry& geometry, const SurfacePoint& point, const Vec3& direction);

}  // namespace gradus::geometry
