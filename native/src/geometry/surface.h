// What a ray meets, before materials.
#pragma once

#include "base/types.h"

namespace gradus::geometry {

// Raw answer of the traversal; what a path needs to find the point again.
struct Hit {
  float t = kInfinity;
  uint32_t instance = UINT32_MAX;  // index in the snapshot
  uint32_t triangle = UINT32_MAX;
  Vec2 barycentric = Vec2(0.0f);  // weights of the 2nd and 3rd corner
  float time = 0.0f;              // of the ray
  bool valid() const { return instance != UINT32_MAX; }
  bool operator==(const Hit&) const = default;
};

// Geometry of a hit, in the snapshot's internal space. The position comes from barycentrics, not from origin +
// t·direction.
struct SurfacePoint {
  Vec3 position = Vec3(0.0f);
  Vec3 geometric_normal =
      Vec3(0, 0, 1);  // unit; the side from which the corners run counter-clockwise (mirrored instances included)
  Vec3 shading_normal = Vec3(0, 0, 1);    // unit; interpolated; not flipped towards the viewer
  float error = 0.0f;                     // bound on the rounding error along the geometric normal, for offset_origin()
  float shadow_terminator_offset = 0.0f;  // of the instance (shadow_terminator.h); 0 where the face is flat
  Hit hit;
  uint32_t material = 0;  // index in the snapshot
};

// `normal` on the side of geometric_normal (both unit): one from the other side is mirrored at the surface. Coarse or
// stretched meshes and strong bumps have normals that lie a little below it; turned round they would face the wrong
// way, and be taken for a back side.
inline Vec3 keep_above(const Vec3& normal, const Vec3& geometric_normal) {
  const float height = glm::dot(normal, geometric_normal);
  return height < 0.0f ? normal - 2.0f * height * geometric_normal : normal;
}

// An origin on the side of `direction` from which a ray cannot hit the surface of `point` again.
Vec3 offset_origin(const SurfacePoint& point, const Vec3& direction);
// Lets a ray go on behind a surface that it met, to the same end. Returns by how much it is shorter, the offset
// included.
float pass_surface(const SurfacePoint& point, Ray* ray);
// The ray to a known place: both ends lie off their surfaces. Where they are closer than the errors of both, so that
// they do not lie one after the other in `direction`, the ray is empty (t_max < 0).
Ray ray_between(const Vec3& start, const Vec3& end, const Vec3& direction, float time);

}  // namespace gradus::geometry
