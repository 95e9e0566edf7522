// A triangle mesh in Blender's layout: values per vertex, per corner and per face, and triangles that refer to corners.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/commit_monitor.h"
#include "base/types.h"
#include "gradus/gradus.h"

namespace gradus::geometry {

struct DicingTree;  // geometry/dicing_tree.h

// Values of one to four channels on the vertices, corners or faces of a mesh.
struct MeshAttribute {
  std::string name;
  GradusDomain domain = GRADUS_DOMAIN_POINT;
  uint32_t channels = 1;
  bool is_uv = false;
  std::vector<float> data;  // `channels` values per element; finite
};

// Value in MeshData::triangle_vertices of a dropped triangle.
inline constexpr uint32_t kDroppedVertex = UINT32_MAX;

// A mesh, immutable once it is made. Positions may be NaN. Triangles that use such vertices are dropped, so that no hit
// lies on one.
struct MeshData {
  std::string name;
  uint32_t vertex_count = 0;
  uint32_t triangle_count = 0;
  std::vector<float> key_times;             // one per key, ascending
  uint32_t frame_key = 0;                   // index of the key nearest to time 0, which is rendered
  std::vector<Vec3> positions;              // all vertices of each key; one more as padding (Embree reads 16 bytes)
  uint32_t shutter_keys = 0;                // number of keys, evenly over the shutter time; 0: does not deform
  std::vector<Vec3> shutter_positions;      // all vertices of each shutter key; one more as padding
  std::vector<Vec3> shutter_normals;        // smooth vertex normals of the rendered frame, then of each shutter key
  std::vector<uint32_t> triangle_vertices;  // 3 per triangle; kDroppedVertex three times: dropped
  std::vector<uint32_t> triangle_corners;   // 3 per triangle
  std::vector<uint32_t> triangle_faces;     // empty: one face per triangle
  std::vector<uint32_t> face_materials;     // material slots; empty: all 0
  GradusDomain normal_domain = GRADUS_DOMAIN_FACE;
  std::vector<Vec3> normals;      // empty: flat shading
  std::vector<float> pointiness;  // of each vertex; empty: the caller gave no edges
  std::vector<uint32_t> islands;  // vertex that stands for the connected part of each vertex; empty as pointiness
  std::vector<MeshAttribute> attributes;
  int32_t default_uv = -1;              // index in attributes; -1: there is no UV map
  uint32_t dicing_levels = 0;           // how often triangles may be divided in four
  float dicing_rate = 0.0f;             // side of a square of two triangles after that, as a share of the picture's
                                        // width; 0: by length
  float dicing_length = 0.0f;           // side of such a square in the mesh's space
  float offscreen_dicing_scale = 1.0f;  // factor of dicing_rate beyond the borders of the picture
  float dicing_tolerance = 1.0f;        // factor by which edges may change before the mesh is diced anew
  Vec3 generated_location{0.0f};
  Vec3 generated_size{1.0f};
  std::vector<Vec3> generated_points;  // empty: positions in the rendered frame
  Vec3 lower{0.0f}, upper{0.0f};       // bounds in the rendered frame, without dropped triangles; lower > upper: empty
  uint32_t dropped_triangles = 0;
  std::shared_ptr<const DicingTree> dicing;  // of a diced mesh
  uint64_t content_hash = 0;
  // Hash of the vertex count and the triangles. Triangles of two frames correspond if it is equal.
  uint64_t topology_hash = 0;

  const Vec3* frame_positions() const { return positions.data() + size_t(frame_key) * vertex_count; }
  bool is_dropped(uint32_t triangle) const { return triangle_vertices[size_t(triangle) * 3] == kDroppedVertex; }
  uint32_t face(uint32_t triangle) const { return triangle_faces.empty() ? triangle : triangle_faces[triangle]; }
  uint32_t material_slot(uint32_t triangle) const {
    return face_materials.empty() ? 0 : face_materials[face(triangle)];
  }
};

// Returns the number of elements of a domain (GradusDomain) of the caller's mesh.
inline size_t domain_size(const GradusMesh& m, uint32_t domain) {
  if (domain == GRADUS_DOMAIN_POINT) return m.vertex_count;
  if (domain == GRADUS_DOMAIN_CORNER) return m.corner_count;
  return m.triangle_faces ? m.face_count : m.triangle_count;
}

// Sets the bounds from the positions in the rendered frame, without dropped triangles.
void set_bounds(MeshData* mesh);
// Sets the smooth normals of all shutter keys, if the mesh deforms and is not shaded flat. Throws Error CANCELLED if
// the monitor says so.
void set_shutter_normals(MeshData* mesh, const CommitMonitor& monitor = {nullptr, nullptr});
// Copies and checks the caller's arrays. Throws Error INVALID_ARGUMENT with the name of the mesh if an array is
// missing, or if counts and indices contradict each other.
std::shared_ptr<const MeshData> make_mesh(const GradusMesh& desc);

// Interpolates the values at the three corners. `barycentric` holds the weights of the 2nd and 3rd corner, as in Hit.
template <class T>
T interpolate(const std::array<T, 3>& v, const Vec2& barycentric) {
  return v[0] * (1.0f - barycentric.x - barycentric.y) + v[1] * barycentric.x + v[2] * barycentric.y;
}

// Position of a time among the time keys of a mesh.
struct MeshMoment {
  uint32_t before = 0, after = 0;  // indices of the keys around the time; equal at and beyond the ends
  float share = 0.0f;              // weight of the key `after`, 0 to 1
};
// Finds a time, in frames relative to the rendered frame, among the keys of a mesh.
MeshMoment mesh_moment(const MeshData& mesh, float time);
// Returns the local corners of a triangle in the rendered frame.
std::array<Vec3, 3> triangle_positions(const MeshData& mesh, uint32_t triangle);
// Returns the local corners of a triangle at a time, in frames relative to the rendered frame. They are interpolated
// linearly between keys.
std::array<Vec3, 3> triangle_positions_at(const MeshData& mesh, uint32_t triangle, float time);
// Returns the local corners of a triangle at a shutter time from 0 to 1. The interpolation is the same as Embree's.
std::array<Vec3, 3> triangle_positions_in_shutter(const MeshData& mesh, uint32_t triangle, float time);
// Returns whether the mesh has shading normals apart from those of its faces.
inline bool has_smooth_normals(const MeshData& mesh) {
  return !mesh.normals.empty() && mesh.normal_domain != GRADUS_DOMAIN_FACE;
}
// Finds the local shading normals of a triangle's corners, not normalised. Returns false if the mesh is shaded flat.
bool triangle_normals(const MeshData& mesh, uint32_t triangle, std::array<Vec3, 3>* normals);
// Finds the normals of triangle_normals() at a shutter time from 0 to 1. In a mesh that deforms they rotate as the
// smooth normals of their vertices do.
bool triangle_normals_in_shutter(const MeshData& mesh, uint32_t triangle, float time, std::array<Vec3, 3>* normals);

// Returns the attribute of that name, or nullptr if there is none.
const MeshAttribute* find_attribute(const MeshData& mesh, std::string_view name);
// Returns the UV map that is used where no name is given, or nullptr if the mesh has no UV map.
const MeshAttribute* default_uv_map(const MeshData& mesh);
// Returns the UV map of that name, or the default one if the name is empty, or nullptr if there is none.
const MeshAttribute* uv_map(const MeshData& mesh, std::string_view name);
// Returns the values of an attribute at the corners of a triangle. Missing channels are 0, a missing fourth channel is
// 1. The corners of a face attribute have the same value.
std::array<Vec4, 3> corner_values(const MeshData& mesh, const MeshAttribute& attribute, uint32_t triangle);
// Returns the generated texture coordinates at a point of a triangle: 0 to 1 over the mesh's texture space.
Vec3 generated_at(const MeshData& mesh, uint32_t triangle, const Vec2& barycentric);

}  // namespace gradus::geometry
