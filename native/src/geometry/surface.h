// The surface point that a ray hits, without its material's properties, and the origins of the next rays.
#pragma once

#include "base/types.h"

namespace gradus::geometry {

// The result of a ray query. It identifies the surface point, so that a path can compute the point again. The kind of
// the primitive is that of the instance's shape: a mesh has triangles. Only geometry/ looks into primitives (and light/
// into emissive triangles): class Geometry computes surface points, surface_values.h what a shape has at a hit.
struct Hit {
  float t = kInfinity;
  uint32_t instance = UINT32_MAX;   // index in Snapshot::instances
  uint32_t primitive = UINT32_MAX;  // index in the instance's shape
  Vec2 uv = Vec2(0.0f);             // parameters on the primitive; triangle: weights of the 2nd and 3rd corner
  float time = 0.0f;                // shutter time of the ray
  bool valid() const { return instance != UINT32_MAX; }
  bool operator==(const Hit&) const = default;
};

// Geometry of a hit, in the snapshot's internal space. The position is computed from the parameters on the primitive,
// which is more precise than origin + t·direction.
struct SurfacePoint {
  Vec3 position = Vec3(0.0f);
  // Unit normal on the side from which the corners run counter-clockwise in the mesh's space, also if it is mirrored.
  Vec3 geometric_normal = Vec3(0, 0, 1);
  Vec3 shading_normal = Vec3(0, 0, 1);    // unit; interpolated; not flipped towards the viewer
  float error = 0.0f;                     // bound on the position's error along the geometric normal
  float shadow_terminator_offset = 0.0f;  // cosine (shadow_terminator.h); 0 if the face is flat
  // Factor of the angle between the normal and a light in the cosine of reflection (bsdf/shading_normal.h).
  float terminator_frequency = 1.0f;
  Hit hit;
  uint32_t material = 0;   // index in Snapshot::materials
  uint64_t light_set = 1;  // bit of the instance's light set as a receiver
};

// How the position on a primitive depends on its parameters, near a hit.
struct SurfaceDerivatives {
  Vec3 dpdu, dpdv;

  // Returns the change of the parameters for a step in the plane of dpdu and dpdv; 0 if these are parallel.
  Vec2 duv(const Vec3& step) const {
    const Vec3 n = glm::cross(dpdu, dpdv);
    const float square = glm::dot(n, n);
    if (!(square > 0.0f)) return Vec2(0.0f);
    return Vec2(glm::dot(glm::cross(step, dpdv), n), glm::dot(glm::cross(dpdu, step), n)) / square;
  }
};

// Returns a normal on the side of geometric_normal (both are unit vectors). A normal on the other side is mirrored at
// the surface's plane. Coarse or stretched meshes and strong bumps have normals a little below the plane. Negating such
// a normal would make it point in almost the opposite direction.
inline Vec3 keep_above(const Vec3& normal, const Vec3& geometric_normal) {
  const float height = glm::dot(normal, geometric_normal);
  return height < 0.0f ? normal - 2.0f * height * geometric_normal : normal;
}

// Returns the origin of a ray that leaves the surface at `point` in `direction`. It is offset from the surface, so that
// the ray cannot hit the same surface again.
Vec3 offset_origin(const SurfacePoint& point, const Vec3& direction);
// Continues a ray behind a surface that it hit, up to the same end. Returns by how much the ray gets shorter, including
// the offset of the new origin.
float pass_surface(const SurfacePoint& point, Ray* ray);
// Returns the ray from start to end, which are both already offset from their surfaces. `direction` is the unit vector
// between the points before the offset. If the offsets exceed the distance, so that `end` is not ahead of `start` in
// `direction`, the ray is empty (t_max < 0).
Ray ray_between(const Vec3& start, const Vec3& end, const Vec3& direction, float time);

}  // namespace gradus::geometry
