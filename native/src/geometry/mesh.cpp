#include "geometry/mesh.h"

#include <algorithm>
#include <cmath>

#include "base/fault.h"
#include "base/minimal_rotation.h"
#include "geometry/matrix_keys.h"

namespace gradus::geometry {

namespace {

// Returns the index of the element of a domain to which corner k of a triangle belongs.
uint32_t element(const MeshData& mesh, GradusDomain domain, uint32_t triangle, uint32_t k) {
  const size_t i = size_t(triangle) * 3 + k;
  if (domain == GRADUS_DOMAIN_POINT) return mesh.triangle_vertices[i];
  if (domain == GRADUS_DOMAIN_CORNER) return mesh.triangle_corners[i];
  return mesh.face(triangle);
}

// Returns the local corners of a triangle in a time key.
std::array<Vec3, 3> positions_of_key(const MeshData& mesh, uint32_t triangle, uint32_t key) {
  const Vec3* p = mesh.positions.data() + size_t(key) * mesh.vertex_count;
  const uint32_t* v = mesh.triangle_vertices.data() + size_t(triangle) * 3;
  return {p[v[0]], p[v[1]], p[v[2]]};
}

// Returns a normal of the rendered frame, rotated as the smooth normal of its vertex rotates from the frame to the
// shutter time.
Vec3 turned_with_vertex(const MeshData& mesh, uint32_t vertex, float time, const Vec3& normal) {
  const KeyPlace place = key_place(time, mesh.shutter_keys);
  const Vec3* key = mesh.shutter_normals.data() + size_t(place.before + 1) * mesh.vertex_count;
  const Vec3 then = key[vertex] * (1.0f - place.share) + key[mesh.vertex_count + vertex] * place.share;
  const Vec3& frame_normal = mesh.shutter_normals[vertex];
  const float length = glm::length(then);
  return length > 1e-6f && frame_normal != Vec3(0.0f) ? turned(normal, frame_normal, then / length) : normal;
}

}  // namespace

std::array<Vec3, 3> triangle_positions(const MeshData& mesh, uint32_t triangle) {
  return positions_of_key(mesh, triangle, mesh.frame_key);
}

MeshMoment mesh_moment(const MeshData& mesh, float time) {
  const auto& times = mesh.key_times;
  const auto last = uint32_t(times.size()) - 1;
  if (last == 0 || time <= times.front()) return {0, 0, 0.0f};
  if (time >= times.back()) return {last, last, 0.0f};
  const auto after = uint32_t(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  return {after - 1, after, (time - times[after - 1]) / (times[after] - times[after - 1])};
}

std::array<Vec3, 3> triangle_positions_at(const MeshData& mesh, uint32_t triangle, float time) {
  const MeshMoment moment = mesh_moment(mesh, time);
  std::array<Vec3, 3> a = positions_of_key(mesh, triangle, moment.before);
  if (moment.after == moment.before) return a;
  const std::array<Vec3, 3> b = positions_of_key(mesh, triangle, moment.after);
  for (size_t i = 0; i < 3; ++i) a[i] += (b[i] - a[i]) * moment.share;
  return a;
}

std::array<Vec3, 3> triangle_positions_in_shutter(const MeshData& mesh, uint32_t triangle, float time) {
  if (mesh.shutter_keys == 0) return triangle_positions(mesh, triangle);
  const KeyPlace place = key_place(time, mesh.shutter_keys);
  const float share = GRADUS_FAULT(deformed_mesh_shaded_at_nearest_key) ? std::round(place.share) : place.share;
  const Vec3* a = mesh.shutter_positions.data() + size_t(place.before) * mesh.vertex_count;
  const Vec3* b = a + mesh.vertex_count;
  std::array<Vec3, 3> p;
  for (size_t k = 0; k < 3; ++k) {
    const uint32_t v = mesh.triangle_vertices[size_t(triangle) * 3 + k];
    p[k] = a[v] * (1.0f - share) + b[v] * share;
  }
  return p;
}

bool triangle_normals(const MeshData& mesh, uint32_t triangle, std::array<Vec3, 3>* normals) {
  if (!has_smooth_normals(mesh)) return false;
  for (uint32_t k = 0; k < 3; ++k) (*normals)[k] = mesh.normals[element(mesh, mesh.normal_domain, triangle, k)];
  return true;
}

bool triangle_normals_in_shutter(const MeshData& mesh, uint32_t triangle, float time, std::array<Vec3, 3>* normals) {
  if (!triangle_normals(mesh, triangle, normals)) return false;
  for (uint32_t k = 0; k < 3 && mesh.shutter_keys > 0 && !GRADUS_FAULT(normals_ignore_deformation); ++k)
    (*normals)[k] = turned_with_vertex(mesh, mesh.triangle_vertices[size_t(triangle) * 3 + k], time, (*normals)[k]);
  return true;
}

const MeshAttribute* find_attribute(const MeshData& mesh, std::string_view name) {
  for (const MeshAttribute& a : mesh.attributes)
    if (a.name == name) return &a;
  return nullptr;
}

const MeshAttribute* default_uv_map(const MeshData& mesh) {
  return mesh.default_uv < 0 ? nullptr : &mesh.attributes[size_t(mesh.default_uv)];
}

const MeshAttribute* uv_map(const MeshData& mesh, std::string_view name) {
  return name.empty() ? default_uv_map(mesh) : find_attribute(mesh, name);
}

std::array<Vec4, 3> corner_values(const MeshData& mesh, const MeshAttribute& attribute, uint32_t triangle) {
  std::array<Vec4, 3> values;
  for (uint32_t k = 0; k < 3; ++k) {
    values[k] = Vec4(0, 0, 0, 1);
    const float* v = attribute.data.data() + size_t(element(mesh, attribute.domain, triangle, k)) * attribute.channels;
    for (uint32_t c = 0; c < attribute.channels; ++c) values[k][int(c)] = v[c];
  }
  return values;
}

Vec3 generated_at(const MeshData& mesh, uint32_t triangle, const Vec2& barycentric) {
  std::array<Vec3, 3> p = triangle_positions(mesh, triangle);
  if (!mesh.generated_points.empty())
    for (uint32_t k = 0; k < 3; ++k) p[k] = mesh.generated_points[element(mesh, GRADUS_DOMAIN_POINT, triangle, k)];
  return (interpolate(p, barycentric) - mesh.generated_location) / (2.0f * mesh.generated_size) + 0.5f;
}

}  // namespace gradus::geometry
