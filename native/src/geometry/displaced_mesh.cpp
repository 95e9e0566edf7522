#include "geometry/displaced_mesh.h"

#include "base/hash.h"
#include "geometry/plane.h"

namespace gradus::geometry {

namespace {

void move_positions(const std::vector<Vec3>& offsets, size_t keys, std::vector<Vec3>* positions) {
  for (size_t k = 0; k < keys; ++k)
    for (size_t i = 0; i < offsets.size(); ++i) (*positions)[k * offsets.size() + i] += offsets[i];
}

// Returns the unit normal of a triangle in the rendered frame, or 0 if it has no area.
Vec3 triangle_normal(const MeshData& mesh, uint32_t triangle) {
  const std::array<Vec3, 3> p = triangle_positions(mesh, triangle);
  return safe_unit(glm::cross(p[1] - p[0], p[2] - p[0]), Vec3(0.0f));
}

// Returns the mean unit normal of the chosen triangles at each vertex; 0 at others.
std::vector<Vec3> mean_normals(const MeshData& mesh, const std::vector<bool>& chosen, const CommitMonitor& monitor) {
  std::vector<Vec3> normals(mesh.vertex_count, Vec3(0.0f));
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    monitor.check_at(t);
    if (!chosen[t] || mesh.is_dropped(t)) continue;
    const Vec3 normal = triangle_normal(mesh, t);
    for (size_t k = 0; k < 3; ++k) normals[mesh.triangle_vertices[size_t(t) * 3 + k]] += normal;
  }
  for (Vec3& n : normals) n = safe_unit(n, Vec3(0.0f));
  return normals;
}

// Calls visit(vertex, element of the normals) for each corner of the chosen triangles.
template <class Visit>
void for_each_corner(const MeshData& mesh, const std::vector<bool>& chosen, const CommitMonitor& monitor,
                     const Visit& visit) {
  const bool by_vertex = mesh.normal_domain == GRADUS_DOMAIN_POINT;
  for (uint32_t t = 0; t < mesh.triangle_count; ++t) {
    monitor.check_at(t);
    if (!chosen[t] || mesh.is_dropped(t)) continue;
    for (size_t i = size_t(t) * 3; i < size_t(t) * 3 + 3; ++i)
      visit(mesh.triangle_vertices[i], by_vertex ? mesh.triangle_vertices[i] : mesh.triangle_corners[i]);
  }
}

// Recomputes the normals of the chosen triangles. Those of corners change as the normal of their vertex does, which
// keeps sharp edges sharp.
void recompute_normals(const MeshData& before, const std::vector<bool>& chosen, const CommitMonitor& monitor,
                       MeshData* mesh) {
  if (mesh->normals.empty() || mesh->normal_domain == GRADUS_DOMAIN_FACE) return;
  if (mesh->normal_domain == GRADUS_DOMAIN_POINT) {
    const std::vector<Vec3> normals = mean_normals(*mesh, chosen, monitor);
    for_each_corner(*mesh, chosen, monitor,
                    [&](uint32_t vertex, uint32_t element) { mesh->normals[element] = normals[vertex]; });
    return;
  }
  const std::vector<bool> all(mesh->triangle_count, true);
  const std::vector<Vec3> old = mean_normals(before, all, monitor), now = mean_normals(*mesh, all, monitor);
  for_each_corner(*mesh, chosen, monitor, [&](uint32_t vertex, uint32_t element) {
    mesh->normals[element] = safe_unit(before.normals[element] + now[vertex] - old[vertex], Vec3(0.0f));
  });
}

uint64_t displaced_hash(const MeshData& mesh, const std::vector<Vec3>& offsets) {
  ContentHash hash;
  hash.value(mesh.content_hash);
  hash.array(offsets);
  hash.array(mesh.normals);
  return hash.result();
}

}  // namespace

std::shared_ptr<const MeshData> displaced_mesh(const MeshData& mesh, const std::vector<Vec3>& offsets,
                                               const std::vector<bool>& moves, const CommitMonitor& monitor) {
  auto moved = std::make_shared<MeshData>(mesh);
  if (moved->generated_points.empty())
    moved->generated_points.assign(mesh.frame_positions(), mesh.frame_positions() + mesh.vertex_count);
  move_positions(offsets, mesh.key_times.size(), &moved->positions);
  move_positions(offsets, mesh.shutter_keys, &moved->shutter_positions);
  set_bounds(moved.get());
  monitor.check();
  recompute_normals(mesh, moves, monitor, moved.get());
  set_shutter_normals(moved.get(), monitor);
  moved->content_hash = displaced_hash(*moved, offsets);
  return moved;
}

}  // namespace gradus::geometry
