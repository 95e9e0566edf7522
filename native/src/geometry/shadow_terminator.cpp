#include "geometry/shadow_terminator.h"

#include "geometry/mesh.h"
#include "geometry/plane.h"

namespace gradus::geometry {

namespace {

// Returns the height of the bulge over a facet at the barycentric coordinates w, for corners p with unit normals n on
// the outer side of the bulge. The height is half of a parabola through the corners, or the envelope of their tangent
// planes where that is higher. It is 0 where the surface is concave.
float bulge(const std::array<Vec3, 3>& p, const std::array<Vec3, 3>& n, const Vec3& w) {
  const Vec3 point = p[0] * w.x + p[1] * w.y + p[2] * w.z;
  const auto bend = [&](int i, int j) { return glm::dot(n[j] - n[i], p[j] - p[i]); };
  const float parabola = bend(0, 1) * w.x * w.y + bend(1, 2) * w.y * w.z + bend(2, 0) * w.z * w.x;
  float envelope = kInfinity;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &next = p[(i + 1) % 3], &last = p[(i + 2) % 3];
    const float lifted = std::max({glm::dot(next - p[i], n[i]), glm::dot(last - p[i], n[i]), 0.0f});
    envelope = std::min(envelope, std::max(glm::dot(p[i] - point, n[i]) + lifted, 0.0f));
  }
  return std::max(envelope, 0.5f * parabola);
}

}  // namespace

Vec3 shadow_origin(const Geometry& geometry, const SurfacePoint& point, const Vec3& direction) {
  const float share = terminator_share(point, direction);
  if (share == 0.0f) return offset_origin(point, direction);
  const InstanceData& instance = geometry.instances[point.hit.instance];
  std::array<Vec3, 3> normals{};
  triangle_normals_in_shutter(*instance.mesh, point.hit.primitive, point.hit.time,
                              &normals);  // the mesh has normals: flat faces have offset 0
  Placement storage;
  const Placement& placement = instance.placement(point.hit.time, &storage);
  // Geometric normal on the light's side of the smooth surface. For a light inside the object, the bulge points
  // inwards.
  const Vec3 outside = std::copysign(1.0f, glm::dot(point.shading_normal, direction)) * point.geometric_normal;
  const Vec3 smooth = placement.normal_to_world * interpolate(normals, point.hit.uv);
  const float side = std::copysign(1.0f, glm::dot(smooth, outside));
  for (Vec3& n : normals) n = side * safe_unit(n, Vec3(0.0f));
  const Vec2 b = point.hit.uv;
  const float height = share * bulge(triangle_positions_in_shutter(*instance.mesh, point.hit.primitive, point.hit.time),
                                     normals, Vec3(1.0f - b.x - b.y, b.x, b.y));
  SurfacePoint lifted = point;
  if (height < kInfinity) lifted.position += Mat3(placement.to_world) * (height * interpolate(normals, b));
  return offset_origin(lifted, outside);
}

}  // namespace gradus::geometry
