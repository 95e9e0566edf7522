#include "geometry/flat_triangle.h"

#include <tbb/parallel_for.h>

namespace gradus::geometry {

FlatTriangles make_flat_triangles(const MeshData& mesh, const Vec3* positions) {
  FlatTriangles out(mesh.triangle_count);
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, mesh.triangle_count, 1 << 12),
                    [&](const tbb::blocked_range<uint32_t>& range) {
                      for (uint32_t i = range.begin(); i < range.end(); ++i) {
                        if (mesh.is_dropped(i)) continue;
                        const uint32_t* v = mesh.triangle_vertices.data() + size_t(i) * 3;
                        out[i].corners = {positions[v[0]], positions[v[1]], positions[v[2]]};
                        out[i].plane = plane_of(out[i].corners);
                        out[i].slot = mesh.material_slot(i);
                      }
                    });
  return out;
}

}  // namespace gradus::geometry
