#include "geometry/displaced_mesh.h"

#include <map>
#include <utility>

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

// Returns for each element of the normals (a vertex or a corner) the element whose sum of normals it shares. Corners
// share it if they have the same vertex and the same normal.
std::vector<uint32_t> shared_elements(const MeshData& mesh) {
  std::vector<uint32_t> shared(mesh.normals.size());
  for (uint32_t i = 0; i < shared.size(); ++i) shared[i] = i;
  if (mesh.normal_domain == GRADUS_DOMAIN_POINT) return shared;
  std::map<std::pair<uint32_t, std::array<float, 3>>, uint32_t> first;
  for (size_t i = 0; i < mesh.triangle_corners.size(); ++i) {
    const uint32_t vertex = mesh.triangle_vertices[i], corner = mesh.triangle_corners[i];
    if (vertex == kDroppedVertex) continue;
    const Vec3& n = mesh.normals[corner];
    shared[corner] = first.try_emplace({vertex, {n.x, n.y, n.z}}, corner).first->second;
  }
  return shared;
}

void recompute_normals(const std::vector<bool>& chosen, MeshData* mesh) {
  if (mesh->normals.empty() || mesh->normal_domain == GRADUS_DOMAIN_FACE) return;
  const bool by_vertex = mesh->normal_domain == GRADUS_DOMAIN_POINT;
  const std::vector<uint32_t> shared = shared_elements(*mesh);
  const std::vector<uint32_t>& elements = by_vertex ? mesh->triangle_vertices : mesh->triangle_corners;
  std::vector<Vec3> sums(mesh->normals.size(), Vec3(0.0f));
  for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
    if (!chosen[t] || mesh->is_dropped(t)) continue;
    const Vec3 normal = triangle_normal(*mesh, t);
    for (size_t k = 0; k < 3; ++k) sums[shared[elements[size_t(t) * 3 + k]]] += normal;
  }
  for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
    if (!chosen[t] || mesh->is_dropped(t)) continue;
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t element = elements[size_t(t) * 3 + k];
      mesh->normals[element] = safe_unit(sums[shared[element]], Vec3(0.0f));
    }
  }
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
                                               const std::vector<bool>& moves) {
  auto moved = std::make_shared<MeshData>(mesh);
  if (moved->generated_points.empty())
    moved->generated_points.assign(mesh.frame_positions(), mesh.frame_positions() + mesh.vertex_count);
  move_positions(offsets, mesh.key_times.size(), &moved->positions);
  move_positions(offsets, mesh.shutter_keys, &moved->shutter_positions);
  set_bounds(moved.get());
  recompute_normals(moves, moved.get());
  set_shutter_normals(moved.get());
  moved->content_hash = displaced_hash(*moved, offsets);
  return moved;
}

}  // namespace gradus::geometry
