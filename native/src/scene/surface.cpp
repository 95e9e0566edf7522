#include "scene/surface.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "scene/mesh.h"
#include "scene/snapshot.h"

namespace gradus {

namespace {

// gamma(n) = n·u / (1 - n·u), the bound of n rounded operations (Higham; pbrt-v4 section 6.8.1).
constexpr float kUnitRoundoff = std::numeric_limits<float>::epsilon() * 0.5f;
constexpr float gamma_bound(int n) { return float(n) * kUnitRoundoff / (1.0f - float(n) * kUnitRoundoff); }

float largest(const Vec3& v) { return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z))); }

// Squares of lengths within these bounds lose nothing to float's range.
constexpr float kSmallestSquare = 1e-30f, kLargestSquare = 1e30f;
bool is_safe_square(float square) { return square > kSmallestSquare && square < kLargestSquare; }

// Unit vector, also where the square of the length leaves float's range; `fallback` where there is none.
Vec3 safe_normalize(const Vec3& v, const Vec3& fallback) {
  const float square = glm::dot(v, v);
  if (is_safe_square(square)) return v * (1.0f / std::sqrt(square));
  const float scale = largest(v);
  if (!(scale > 0.0f) || !is_finite(scale)) return fallback;
  return glm::normalize(v / scale);
}

struct Plane {
  Vec3 normal;  // unit
  float error;  // of the plane equation that the next ray computes, see below
};

// The next ray's plane equation is computed from the corners relative to its origin: rounding grows with the size of the triangle,
// and once more where two short edges are nearly parallel, because the normal comes from them.
float plane_error(const Vec3 e[3], float squared_area) {
  const float a = glm::dot(e[0], e[0]), b = glm::dot(e[1], e[1]), c = glm::dot(e[2], e[2]);
  const float low = std::min(a, std::min(b, c)), high = std::max(a, std::max(b, c));
  const float middle = std::max(std::min(a, b), std::min(std::max(a, b), c));
  const float squared_conditioning = low * (middle / squared_area);
  return gamma_bound(8) * std::sqrt(high) * std::sqrt(std::clamp(squared_conditioning, 1.0f, 1e8f));
}

Plane plane_of(const std::array<Vec3, 3>& p) {
  const Vec3 e[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const Vec3 cross = glm::cross(e[0], p[2] - p[0]);  // not -e[2]: zeros keep their sign, which tangents follow
  const float square = glm::dot(cross, cross);
  if (is_safe_square(square)) return {cross * (1.0f / std::sqrt(square)), plane_error(e, square)};
  // Coordinates beyond 1e19, or tiny triangles: scaled to where squares are safe.
  const float scale = std::max(largest(e[0]), std::max(largest(e[1]), largest(e[2])));
  const Vec3 normal = scale > 0.0f ? safe_normalize(glm::cross(e[0] / scale, -e[2] / scale), Vec3(0, 0, 1)) : Vec3(0, 0, 1);
  return {normal, plane_error(e, square)};
}

// As stored: in internal space if the mesh lies in the top level, else in the mesh's own.
std::array<Vec3, 3> stored_corners(const InstanceData& instance, uint32_t triangle) {
  if (!instance.flat_positions) return triangle_positions(*instance.mesh, triangle);
  const uint32_t* v = instance.mesh->triangle_vertices.data() + size_t(triangle) * 3;
  return {instance.flat_positions[v[0]], instance.flat_positions[v[1]], instance.flat_positions[v[2]]};
}

// |m|·v + |t|, the size of the terms that an affine transformation adds up.
Vec3 magnitudes(const Mat4& m, const Vec3& v) {
  return glm::abs(Vec3(m[0])) * v.x + glm::abs(Vec3(m[1])) * v.y + glm::abs(Vec3(m[2])) * v.z + glm::abs(Vec3(m[3]));
}

// Linear in the barycentrics; where the mesh is flat or its normals are broken, the geometric normal.
Vec3 shading_normal(const InstanceData& instance, const Hit& hit, const Vec3& geometric) {
  std::array<Vec3, 3> n;
  if (!triangle_normals(*instance.mesh, hit.triangle, &n)) return geometric;
  return safe_normalize(instance.normal_to_world * interpolate(n, hit.barycentric), geometric);
}

void place_flat(const InstanceData& instance, const Hit& hit, SurfacePoint* point) {
  const std::array<Vec3, 3> p = stored_corners(instance, hit.triangle);
  const std::array<Vec3, 3> sizes = {glm::abs(p[0]), glm::abs(p[1]), glm::abs(p[2])};
  point->position = interpolate(p, hit.barycentric);
  const Plane plane = plane_of(p);
  point->geometric_normal = instance.mirrored ? -plane.normal : plane.normal;
  const Vec3 error = gamma_bound(7) * interpolate(sizes, hit.barycentric);
  point->error = glm::dot(glm::abs(point->geometric_normal), error) + plane.error;
}

void place_instanced(const InstanceData& instance, const Hit& hit, SurfacePoint* point) {
  const std::array<Vec3, 3> p = stored_corners(instance, hit.triangle);
  const Plane plane = plane_of(p);
  const Vec3 local = interpolate(p, hit.barycentric);
  const Vec3 local_size = interpolate(std::array<Vec3, 3>{glm::abs(p[0]), glm::abs(p[1]), glm::abs(p[2])}, hit.barycentric);
  point->position = Vec3(instance.to_world * Vec4(local, 1.0f));
  point->geometric_normal = safe_normalize(instance.normal_to_world * plane.normal, Vec3(0, 0, 1));
  // There: corners, sum, matrix. And back: Embree takes the next ray into the mesh's space, with rounding of its own there.
  const Mat4 linear(instance.to_world[0], instance.to_world[1], instance.to_world[2], Vec4(0.0f));
  const Vec3 back = magnitudes(instance.to_local, glm::abs(point->position));
  const Vec3 error = magnitudes(instance.to_world, local_size) * gamma_bound(8) + magnitudes(linear, back) * gamma_bound(8) +
                     magnitudes(linear, Vec3(plane.error));
  point->error = glm::dot(glm::abs(point->geometric_normal), error);
}

// The float next to v in the direction of `up`: std::nextafter for finite v, without the call.
float step_away(float v, float up) {
  if (up == 0.0f) return v;
  if (v == 0.0f) return std::copysign(std::numeric_limits<float>::denorm_min(), up);
  const auto bits = std::bit_cast<uint32_t>(v);
  return std::bit_cast<float>((v > 0.0f) == (up > 0.0f) ? bits + 1 : bits - 1);
}

}  // namespace

uint32_t Snapshot::material_of(uint32_t instance, uint32_t triangle) const {
  const InstanceData& data = instances[instance];
  if (data.materials.empty()) return 0;
  // Blender shows the last slot where a face names one that does not exist.
  return data.materials[std::min<size_t>(data.mesh->material_slot(triangle), data.materials.size() - 1)];
}

SurfacePoint Snapshot::surface_point(const Hit& hit) const {
  const InstanceData& instance = instances[hit.instance];
  SurfacePoint point;
  point.hit = hit;
  if (instance.flat_positions)
    place_flat(instance, hit, &point);
  else
    place_instanced(instance, hit, &point);
  point.shading_normal = shading_normal(instance, hit, point.geometric_normal);
  point.material = material_of(hit.instance, hit.triangle);
  return point;
}

std::array<Vec3, 3> Snapshot::corners(uint32_t index, uint32_t triangle) const {
  const InstanceData& instance = instances[index];
  std::array<Vec3, 3> p = stored_corners(instance, triangle);
  if (!instance.flat_positions) {
    for (Vec3& v : p) v = Vec3(instance.to_world * Vec4(v, 1.0f));
  }
  return p;
}

Vec3 Snapshot::position_at(const Hit& hit, bool next) const {
  const InstanceData& instance = instances[hit.instance];
  const Mat4& to_world = next ? instance.to_world_next : instance.to_world_previous;
  // At rest the very same position, so that its motion is exactly zero.
  if (instance.mesh->key_times.size() == 1 && to_world == instance.to_world) return surface_point(hit).position;
  const Vec3 local = interpolate(triangle_positions_at(*instance.mesh, hit.triangle, next ? 1.0f : -1.0f), hit.barycentric);
  return Vec3(to_world * Vec4(local, 1.0f));
}

// pbrt-v4 section 6.8.6: along the geometric normal by the bound, then one float further so that rounding the sum cannot undo it.
Vec3 offset_origin(const SurfacePoint& point, const Vec3& direction) {
  const Vec3 n = point.geometric_normal;
  const Vec3 offset = n * (glm::dot(n, direction) < 0.0f ? -point.error : point.error);
  const Vec3 p = point.position + offset;
  return Vec3(step_away(p.x, offset.x), step_away(p.y, offset.y), step_away(p.z, offset.z));
}

float pass_surface(const SurfacePoint& point, Ray* ray) {
  const Vec3 next = offset_origin(point, ray->direction);
  const float step = glm::dot(next - ray->origin, ray->direction);
  ray->origin = next;
  ray->t_min = 0.0f;
  ray->t_max -= step;
  return step;
}

Ray ray_between(const Vec3& start, const Vec3& end, const Vec3& direction) {
  const Vec3 line = end - start;
  const float length = glm::length(line);
  if (!(length > 0.0f) || glm::dot(line, direction) <= 0.0f) return Ray{start, 0.0f, direction, -1.0f};
  return Ray{start, 0.0f, line / length, length * (1.0f - 1e-6f)};
}

}  // namespace gradus
