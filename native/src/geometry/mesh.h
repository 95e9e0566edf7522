// A triangle mesh in the layout that Blender hands over: values per vertex, per corner and per face, triangles by
// corners.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::geometry {

struct MeshAttribute {
  std::string name;
  GradusDomain domain = GRADUS_DOMAIN_POINT;
  uint32_t channels = 1;
  bool is_uv = false;
  std::vector<float> data;  // channels per element; finite
};

inline constexpr uint32_t kDroppedVertex = UINT32_MAX;

// Immutable once made. Positions may hold NaN; triangles that use such vertices are dropped, so that no hit ever lies
// on one.
struct MeshData {
  std::string name;
  uint32_t vertex_count = 0;
  uint32_t triangle_count = 0;
  std::vector<float> key_times;         // one per key, ascending
  uint32_t frame_key = 0;               // the key at time 0 (or nearest to it): what is rendered
  std::vector<Vec3> positions;          // key after key, and one element of padding (Embree reads 16 bytes)
  uint32_t shutter_keys = 0;            // evenly over the time that the shutter is open; 0: stands still then
  std::vector<Vec3> shutter_positions;  // key after key, padded likewise
  std::vector<Vec3> shutter_normals;    // smooth normals of the vertices: of the rest key, then of each of these keys
  std::vector<uint32_t> triangle_vertices;  // 3 per triangle; kDroppedVertex three times: dropped
  std::vector<uint32_t> triangle_corners;   // 3 per triangle
  std::vector<uint32_t> triangle_faces;     // empty: one face per triangle
  std::vector<uint32_t> face_materials;     // slots; empty: all 0
  GradusDomain normal_domain = GRADUS_DOMAIN_FACE;
  std::vector<Vec3> normals;  // empty: flat
  std::vector<MeshAttribute> attributes;
  int32_t default_uv = -1;  // index in attributes
  Vec3 generated_location{0.0f};
  Vec3 generated_size{1.0f};
  std::vector<Vec3> generated_points;  // empty: positions of the rest key
  Vec3 lower{0.0f}, upper{0.0f};       // bounds of the triangles kept, rest key; lower > upper: there are none
  uint32_t dropped_triangles = 0;
  uint64_t content_hash = 0;
  uint64_t topology_hash = 0;  // of vertex count and triangles: equal where a triangle of one frame is that of another

  const Vec3* frame_positions() const { return positions.data() + size_t(frame_key) * vertex_count; }
  bool is_dropped(uint32_t triangle) const { return triangle_vertices[size_t(triangle) * 3] == kDroppedVertex; }
  uint32_t face(uint32_t triangle) const { return triangle_faces.empty() ? triangle : triangle_faces[triangle]; }
  uint32_t material_slot(uint32_t triangle) const {
    return face_materials.empty() ? 0 : face_materials[face(triangle)];
  }
};

// Elements of a domain of the mesh as given.
inline size_t domain_size(const GradusMesh& m, uint32_t domain) {
  if (domain == GRADUS_DOMAIN_POINT) return m.vertex_count;
  if (domain == GRADUS_DOMAIN_CORNER) return m.corner_count;
  return m.triangle_faces ? m.face_count : m.triangle_count;
}

// Copies and checks. Throws Error INVALID_ARGUMENT that names the mesh for counts and indices that contradict each
// other.
std::shared_ptr<const MeshData> make_mesh(const GradusMesh& desc);

// barycentric: weights of the 2nd and 3rd corner, as in Hit.
template <class T>
T interpolate(const std::array<T, 3>& v, const Vec2& barycentric) {
  return v[0] * (1.0f - barycentric.x - barycentric.y) + v[1] * barycentric.x + v[2] * barycentric.y;
}

// Place of a time (frames relative to the one rendered) among a mesh's keys: the share of the second.
struct MeshMoment {
  uint32_t before = 0, after = 0;
  float share = 0.0f;
};
MeshMoment mesh_moment(const MeshData& mesh, float time);
// Local vertex positions of a triangle at a time (frames relative to the one rendered), linear between keys.
std::array<Vec3, 3> triangle_positions(const MeshData& mesh, uint32_t triangle);
std::array<Vec3, 3> triangle_positions_at(const MeshData& mesh, uint32_t triangle, float time);
// At a time of the shutter, as Embree has it.
std::array<Vec3, 3> triangle_positions_in_shutter(const MeshData& mesh, uint32_t triangle, float time);
// Local shading normals of the corners, not normalised; false: the mesh is flat there.
bool triangle_normals(const MeshData& mesh, uint32_t triangle, std::array<Vec3, 3>* normals);
// At a time of the shutter: in a mesh that deforms they turn as the smooth normals of their vertices do.
bool triangle_normals_in_shutter(const MeshData& mesh, uint32_t triangle, float time, std::array<Vec3, 3>* normals);

// nullptr: there is none of that name (or, for the default UV map, none at all).
const MeshAttribute* find_attribute(const MeshData& mesh, const std::string& name);
const MeshAttribute* default_uv_map(const MeshData& mesh);
// Values of an attribute at the corners of a triangle (face domain: three times the same). Channels that it lacks are
// 0, the fourth 1.
std::array<Vec4, 3> corner_values(const MeshData& mesh, const MeshAttribute& attribute, uint32_t triangle);
// Generated texture coordinates, 0..1 over the texture space.
Vec3 generated_at(const MeshData& mesh, uint32_t triangle, const Vec2& barycentric);

}  // namespace gradus::geometry
