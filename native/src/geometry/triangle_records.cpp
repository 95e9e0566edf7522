#include "geometry/triangle_records.h"

#include <tbb/parallel_for.h>

namespace gradus::geometry {

TriangleRecords make_triangle_records(const MeshData& mesh, const Vec3* positions, const Mat3& normal_to_space) {
  TriangleRecords records;
  records.triangles.resize(mesh.triangle_count);
  if (has_smooth_normals(mesh)) records.normals.resize(mesh.triangle_count);
  const auto make = [&](uint32_t i) {
    const bool has_normals = !records.normals.empty();
    if (mesh.is_dropped(i)) {
      records.triangles[i] = {};
      if (has_normals) records.normals[i] = {};
      return;
    }
    const uint32_t* v = mesh.triangle_vertices.data() + size_t(i) * 3;
    const std::array<Vec3, 3> corners = {positions[v[0]], positions[v[1]], positions[v[2]]};
    records.triangles[i] = {corners, plane_of(corners), mesh.material_slot(i)};
    if (!has_normals) return;
    triangle_normals(mesh, i, &records.normals[i].corners);
    for (Vec3& normal : records.normals[i].corners) normal = normal_to_space * normal;
  };
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, mesh.triangle_count, 1 << 12),
                    [&](const tbb::blocked_range<uint32_t>& range) {
                      for (uint32_t i = range.begin(); i < range.end(); ++i) make(i);
                    });
  return records;
}

}  // namespace gradus::geometry
