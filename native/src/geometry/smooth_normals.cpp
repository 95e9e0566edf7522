#include "geometry/smooth_normals.h"

#include <cmath>

namespace gradus::geometry {

std::vector<Vec3> smooth_normals(const MeshData& mesh, const Vec3* p) {
  std::vector<Vec3> normals(mesh.vertex_count, Vec3(0.0f));
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    if (mesh.is_dropped(t)) continue;
    const uint32_t* v = mesh.triangle_vertices.data() + size_t(t) * 3;
    const Vec3 across = glm::cross(p[v[1]] - p[v[0]], p[v[2]] - p[v[0]]);
    const float doubled_area = glm::length(across);
    if (!(doubled_area > 0.0f)) continue;
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = p[v[(k + 1) % 3]] - p[v[k]], b = p[v[(k + 2) % 3]] - p[v[k]];
      normals[v[k]] += across * (std::atan2(doubled_area, glm::dot(a, b)) / doubled_area);
    }
  }
  for (Vec3& n : normals) {
    const float length = glm::length(n);
    if (length > 0.0f) n /= length;
  }
  return normals;
}

}  // namespace gradus::geometry
