#include "geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/fault.h"
#include "geometry/geometry.h"
#include "geometry/mesh.h"
#include "geometry/triangle_records.h"

namespace gradus::geometry {

namespace {

// Returns |A|·v + |t| for the affine matrix m = (A, t): the magnitude of the terms that the transformation of a point
// adds.
Vec3 magnitudes(const Mat4& m, const Vec3& v) {
  return glm::abs(Vec3(m[0])) * v.x + glm::abs(Vec3(m[1])) * v.y + glm::abs(Vec3(m[2])) * v.z + glm::abs(Vec3(m[3]));
}

// Finds the interpolated normal of a hit in internal space, not normalised. Returns false if the mesh is shaded flat.
bool find_smooth_normal(const InstanceData& instance, const Placement& placement, const Hit& hit, Vec3* normal) {
  std::array<Vec3, 3> n;
  if (instance.normals)
    n = instance.normals[hit.primitive].corners;
  else if (instance.triangles || !triangle_normals_in_shutter(*instance.mesh, hit.primitive, hit.time, &n))
    return false;
  *normal = interpolate(n, hit.uv);
  if (!instance.is_in_top_level) *normal = placement.normal_to_world * *normal;
  return true;
}

// Sets the shading normal: the corner normals interpolated linearly, or the geometric normal if the mesh is flat or its
// normals have no direction.
void set_shading_normal(const InstanceData& instance, const Placement& placement, const Hit& hit, SurfacePoint* point) {
  const Vec3& geometric = point->geometric_normal;
  Vec3 normal;
  const bool smooth = find_smooth_normal(instance, placement, hit, &normal);
  point->shading_normal = smooth ? keep_above(safe_unit(normal, geometric), geometric) : geometric;
  point->shadow_terminator_offset = smooth ? instance.shadow_terminator_offset : 0.0f;
}

// Returns the material of a slot. For a slot that does not exist it is that of the last slot, as in Blender.
uint32_t material_of_slot(const InstanceData& instance, uint32_t slot) {
  return instance.materials.empty() ? 0 : instance.materials[std::min<size_t>(slot, instance.materials.size() - 1)];
}

// Computes the surface point of a triangle in the top level, without the shading normal.
void place_flat(const InstanceData& instance, const Hit& hit, SurfacePoint* point) {
  const TriangleRecord& triangle = instance.triangles[hit.primitive];
  const std::array<Vec3, 3>& p = triangle.corners;
  const std::array<Vec3, 3> sizes = {glm::abs(p[0]), glm::abs(p[1]), glm::abs(p[2])};
  point->position = interpolate(p, hit.uv);
  point->geometric_normal =
      instance.mirrored != GRADUS_FAULT(flat_normals_flipped) ? -triangle.plane.normal : triangle.plane.normal;
  const Vec3 error = gamma_bound(7) * interpolate(sizes, hit.uv);
  point->error = glm::dot(glm::abs(point->geometric_normal), error) + triangle.plane.error;
  point->material = material_of_slot(instance, triangle.slot);
}

// Returns the record of a triangle of an instanced mesh at a shutter time.
TriangleRecord local_triangle(const InstanceData& instance, uint32_t triangle, float time) {
  if (instance.triangles) return instance.triangles[triangle];
  TriangleRecord record;
  record.corners = triangle_positions_in_shutter(*instance.mesh, triangle, time);
  record.plane = plane_of(record.corners);
  record.slot = instance.mesh->material_slot(triangle);
  return record;
}

// Computes the surface point of a triangle of an instanced mesh, without the shading normal.
void place_instanced(const InstanceData& instance, const Placement& placement, const Hit& hit, SurfacePoint* point) {
  const TriangleRecord triangle = local_triangle(instance, hit.primitive, hit.time);
  const std::array<Vec3, 3>& p = triangle.corners;
  const Plane& plane = triangle.plane;
  const Vec3 local = interpolate(p, hit.uv);
  const Vec3 local_size = interpolate(std::array<Vec3, 3>{glm::abs(p[0]), glm::abs(p[1]), glm::abs(p[2])}, hit.uv);
  point->position = Vec3(placement.to_world * Vec4(local, 1.0f));
  point->geometric_normal = safe_unit(placement.normal_to_world * plane.normal, Vec3(0, 0, 1));
  // Number of rounded operations: interpolation of the corners, sum, and transformation to internal space. Embree
  // transforms the next ray back to the mesh's space, with as many. Motion adds the interpolation between keys.
  const int roundings = instance.moves() ? 16 : 8;
  const Mat4 linear(placement.to_world[0], placement.to_world[1], placement.to_world[2], Vec4(0.0f));
  const Vec3 back = magnitudes(placement.to_local, glm::abs(point->position));
  const Vec3 error = magnitudes(placement.to_world, local_size) * gamma_bound(roundings) +
                     magnitudes(linear, back) * gamma_bound(roundings) + magnitudes(linear, Vec3(plane.error));
  point->error = glm::dot(glm::abs(point->geometric_normal), error);
  point->material = material_of_slot(instance, triangle.slot);
}

// Computes the surface point without the shading normal and what depends on the instance alone.
void place_on_facet(const InstanceData& instance, const Placement& placement, const Hit& hit, SurfacePoint* point) {
  if (instance.is_in_top_level)
    place_flat(instance, hit, point);
  else
    place_instanced(instance, placement, hit, point);
}

void place_at(const InstanceData& instance, const Placement& placement, const Hit& hit, SurfacePoint* point) {
  place_on_facet(instance, placement, hit, point);
  set_shading_normal(instance, placement, hit, point);
  point->terminator_frequency = instance.terminator_frequency;
  point->light_set = instance.light_set;
}

// Calls use(placement) with the placement of an instance at a shutter time.
template <class Use>
[[gnu::always_inline]] inline void with_placement(const InstanceData& instance, float time, const Use& use) {
  if (!instance.keys) return use(instance);
  Placement storage;
  use(instance.placement(time, &storage));
}

// Returns for each component the float next to v in the direction of the sign of `up`, as std::nextafter does for
// finite v; v if `up` is 0. It computes with bits instead of branches, because branch prediction fails for the signs.
Vec3 step_away(const Vec3& v, const Vec3& up) {
  using Floats = float __attribute__((vector_size(16)));
  using Bits = int32_t __attribute__((vector_size(16)));
  const Floats from{v.x, v.y, v.z, 0.0f}, towards{up.x, up.y, up.z, 0.0f};
  const Bits bits = (Bits)from, up_bits = (Bits)towards;
  const Bits away = bits + (((bits ^ up_bits) >> 31) | 1);
  const Bits from_zero = (up_bits & std::numeric_limits<int32_t>::min()) | 1;  // the smallest float of that sign
  const Bits next = from == 0.0f ? from_zero : away;
  const Floats result = (Floats)(towards == 0.0f ? bits : next);
  return Vec3(result[0], result[1], result[2]);
}

}  // namespace

const Placement& InstanceData::placement(float time, Placement* storage) const {
  if (!keys) return *this;
  *storage = make_placement(glm::dmat4(keys->at(time)));
  return *storage;
}

uint32_t Geometry::material_of(uint32_t index, uint32_t primitive) const {
  const InstanceData& instance = instances[index];
  return material_of_slot(
      instance, instance.triangles ? instance.triangles[primitive].slot : instance.mesh->material_slot(primitive));
}

void place(const InstanceData& instance, const Hit& hit, SurfacePoint* point) {
  point->hit = hit;
  with_placement(instance, hit.time, [&](const Placement& placement) { place_at(instance, placement, hit, point); });
}

void Geometry::place(const Hit& hit, SurfacePoint* point) const {
  geometry::place(instances[hit.instance], hit, point);
}

void Geometry::prefetch(const Hit& hit) const {
  if (!hit.valid()) return;
  const InstanceData& instance = instances[hit.instance];
  if (instance.triangles) __builtin_prefetch(&instance.triangles[hit.primitive]);
  if (instance.normals) {
    __builtin_prefetch(&instance.normals[hit.primitive].corners.front());
    __builtin_prefetch(&instance.normals[hit.primitive].corners.back());
  }
}

SurfacePoint Geometry::surface_point(const Hit& hit) const {
  SurfacePoint point;
  place(hit, &point);
  return point;
}

SurfacePoint Geometry::facet_point(const Hit& hit) const {
  const InstanceData& instance = instances[hit.instance];
  SurfacePoint point;
  point.hit = hit;
  with_placement(instance, hit.time, [&](const Placement& at) { place_on_facet(instance, at, hit, &point); });
  return point;
}

std::array<Vec3, 3> corners(const InstanceData& instance, uint32_t triangle, float time) {
  if (instance.is_in_top_level) return instance.triangles[triangle].corners;
  std::array<Vec3, 3> p = triangle_positions_in_shutter(*instance.mesh, triangle, time);
  const Mat4 to_world = instance.keys ? instance.keys->at(time) : instance.to_world;
  for (Vec3& v : p) v = Vec3(to_world * Vec4(v, 1.0f));
  return p;
}

std::array<Vec3, 3> Geometry::corners(uint32_t index, uint32_t triangle, float time) const {
  return geometry::corners(instances[index], triangle, time);
}

Vec3 Geometry::position(const Hit& hit) const {
  return interpolate(corners(hit.instance, hit.primitive, hit.time), hit.uv);
}

SurfaceDerivatives derivatives(const InstanceData& instance, const Hit& hit) {
  const std::array<Vec3, 3> p = corners(instance, hit.primitive, hit.time);
  return {p[1] - p[0], p[2] - p[0]};
}

SurfaceDerivatives Geometry::derivatives(const Hit& hit) const {
  return geometry::derivatives(instances[hit.instance], hit);
}

float Geometry::curvature(const Hit& hit) const {
  const InstanceData& instance = instances[hit.instance];
  std::array<Vec3, 3> n;
  if (!triangle_normals_in_shutter(*instance.mesh, hit.primitive, hit.time, &n)) return 0.0f;
  const std::array<Vec3, 3> p = corners(hit.instance, hit.primitive, hit.time);
  Placement storage;
  const Placement& placement = instance.placement(hit.time, &storage);
  for (Vec3& v : n) v = glm::normalize(placement.normal_to_world * v);
  float largest = 0.0f;
  for (size_t i = 0; i < 3; ++i) {
    const size_t next = (i + 1) % 3;
    const float length = glm::length(p[next] - p[i]);
    if (length > 0.0f) largest = std::max(largest, glm::length(n[next] - n[i]) / length);
  }
  return largest;
}

Vec3 Geometry::position_at(const Hit& hit, Moment when) const {
  const InstanceData& instance = instances[hit.instance];
  const Mat4& to_world = when == Moment::Now    ? instance.to_world
                         : when == Moment::Next ? instance.to_world_next
                                                : instance.to_world_previous;
  // A static point has exactly the same position, so that its motion is exactly zero.
  if (instance.mesh->key_times.size() == 1 && to_world == instance.to_world && !instance.moves())
    return surface_point(hit).position;
  const float frames = when == Moment::Now ? 0.0f : when == Moment::Next ? 1.0f : -1.0f;
  const Vec3 local = interpolate(triangle_positions_at(*instance.mesh, hit.primitive, frames), hit.uv);
  return Vec3(to_world * Vec4(local, 1.0f));
}

// Moves the point along the geometric normal by the error bound, then to the next float, so that the rounding of the
// sum cannot undo the step. Source: pbrt-v4 section 6.8.6.
Vec3 offset_origin(const SurfacePoint& point, const Vec3& direction) {
  const Vec3 n = point.geometric_normal;
  const Vec3 offset = n * std::copysign(point.error, glm::dot(n, direction));
  const Vec3 p = point.position + offset;
  return step_away(p, offset);
}

float pass_surface(const SurfacePoint& point, Ray* ray) {
  const Vec3 next = offset_origin(point, ray->direction);
  const float step = glm::dot(next - ray->origin, ray->direction);
  ray->origin = next;
  ray->t_min = 0.0f;
  ray->t_max -= step;
  return step;
}

Ray ray_between(const Vec3& start, const Vec3& end, const Vec3& direction, float time) {
  const Vec3 line = end - start;
  const float length = glm::length(line);
  if (!(length > 0.0f) || glm::dot(line, direction) <= 0.0f) return Ray{start, 0.0f, direction, -1.0f, time};
  return Ray{start, 0.0f, line / length, length * (1.0f - 1e-6f), time};
}

}  // namespace gradus::geometry
