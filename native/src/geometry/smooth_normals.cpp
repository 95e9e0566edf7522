#include "geometry/smooth_normals.h"

#include <algorithm>
#include <cmath>

namespace gradus::geometry {

namespace {

// Sets the vertices of the polygon that the triangles [begin, end) of one face make, in the order of its corners.
// Returns false if they make none: some of them are dropped, or they do not have consecutive corners.
bool find_polygon(const MeshData& mesh, uint32_t begin, uint32_t end, std::vector<uint32_t>* polygon) {
  const auto corners = mesh.triangle_corners.begin();
  const auto [lowest, highest] = std::minmax_element(corners + 3 * ptrdiff_t(begin), corners + 3 * ptrdiff_t(end));
  const uint32_t first = *lowest, count = end - begin + 2;
  if (*highest - first + 1 != count) return false;
  polygon->assign(count, kDroppedVertex);
  for (size_t i = 3 * size_t(begin); i < 3 * size_t(end); ++i)
    (*polygon)[mesh.triangle_corners[i] - first] = mesh.triangle_vertices[i];
  return std::find(polygon->begin(), polygon->end(), kDroppedVertex) == polygon->end();
}

// Adds the normal of a polygon to those of its vertices, weighted by its angles there.
void add_polygon(const std::vector<uint32_t>& v, const Vec3* p, std::vector<Vec3>* normals) {
  const size_t count = v.size();
  Vec3 across(0.0f);
  for (size_t i = 2; i < count; ++i) across += glm::cross(p[v[i - 1]] - p[v[0]], p[v[i]] - p[v[0]]);
  const float length = glm::length(across);
  if (!(length > 0.0f)) return;
  for (size_t i = 0; i < count; ++i) {
    const Vec3 a = p[v[(i + 1) % count]] - p[v[i]], b = p[v[(i + count - 1) % count]] - p[v[i]];
    (*normals)[v[i]] += across * (std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / length);
  }
}

}  // namespace

std::vector<Vec3> smooth_normals(const MeshData& mesh, const Vec3* positions, const CommitMonitor& monitor) {
  std::vector<Vec3> normals(mesh.vertex_count, Vec3(0.0f));
  std::vector<uint32_t> polygon;
  uint32_t faces = 0;
  for (uint32_t begin = 0, end = 0; begin < mesh.triangle_count; begin = end) {
    monitor.check_at(faces++);
    for (end = begin + 1; end < mesh.triangle_count && mesh.face(end) == mesh.face(begin);) ++end;
    if (find_polygon(mesh, begin, end, &polygon)) {
      add_polygon(polygon, positions, &normals);
      continue;
    }
    for (uint32_t t = begin; t < end; ++t) {
      if (mesh.is_dropped(t)) continue;
      const auto vertices = mesh.triangle_vertices.begin() + 3 * ptrdiff_t(t);
      polygon.assign(vertices, vertices + 3);
      add_polygon(polygon, positions, &normals);
    }
  }
  for (Vec3& n : normals) {
    const float length = glm::length(n);
    if (length > 0.0f) n /= length;
  }
  return normals;
}

}  // namespace gradus::geometry
