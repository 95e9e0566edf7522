#include "geometry/mesh_at.h"

#include "base/hash.h"
#include "base/minimal_rotation.h"
#include "geometry/smooth_normals.h"

namespace gradus::geometry {

namespace {

// Returns the local vertex positions at a time, and one element of padding.
std::vector<Vec3> positions_at(const MeshData& mesh, float frames) {
  const MeshMoment moment = mesh_moment(mesh, frames);
  const Vec3* before = mesh.positions.data() + size_t(moment.before) * mesh.vertex_count;
  const Vec3* after = mesh.positions.data() + size_t(moment.after) * mesh.vertex_count;
  std::vector<Vec3> positions(size_t(mesh.vertex_count) + 1, Vec3(0.0f));
  for (size_t i = 0; i < mesh.vertex_count; ++i) positions[i] = before[i] + (after[i] - before[i]) * moment.share;
  return positions;
}

// Rotates the normals of `mesh` as the smooth vertex normals rotate from the rendered frame of `from` to the positions
// of `mesh`.
void turn_normals(const MeshData& from, MeshData* mesh) {
  if (mesh->normals.empty() || mesh->normal_domain == GRADUS_DOMAIN_FACE) return;
  const std::vector<Vec3> before = smooth_normals(from, from.frame_positions()),
                          now = smooth_normals(*mesh, mesh->positions.data());
  const bool by_vertex = mesh->normal_domain == GRADUS_DOMAIN_POINT;
  std::vector<bool> done(mesh->normals.size());
  for (size_t i = 0; i < mesh->triangle_vertices.size(); ++i) {
    const uint32_t vertex = mesh->triangle_vertices[i];
    const uint32_t element = by_vertex ? vertex : mesh->triangle_corners[i];
    if (vertex == kDroppedVertex || done[element]) continue;
    done[element] = true;
    if (before[vertex] != Vec3(0.0f) && now[vertex] != Vec3(0.0f))
      mesh->normals[element] = turned(mesh->normals[element], before[vertex], now[vertex]);
  }
}

}  // namespace

std::shared_ptr<const MeshData> mesh_at(const MeshData& mesh, float frames) {
  auto moved = std::make_shared<MeshData>(mesh);
  moved->positions = positions_at(mesh, frames);
  moved->key_times = {0.0f};
  moved->frame_key = 0;
  moved->shutter_keys = 0;
  moved->shutter_positions.clear();
  moved->shutter_normals.clear();
  if (moved->generated_points.empty())
    moved->generated_points.assign(mesh.frame_positions(), mesh.frame_positions() + mesh.vertex_count);
  turn_normals(mesh, moved.get());
  set_bounds(moved.get());
  ContentHash hash;
  hash.value(mesh.content_hash);
  hash.value(frames);
  moved->content_hash = hash.result();
  return moved;
}

}  // namespace gradus::geometry
