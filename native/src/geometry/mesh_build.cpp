// Conversion of the caller's arrays to MeshData, with all checks of these arrays.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/hash.h"
#include "geometry/edge_values.h"
#include "geometry/matrix_keys.h"
#include "geometry/mesh.h"
#include "geometry/smooth_normals.h"

namespace gradus::geometry {

namespace {

// Maximum number of elements. Indices have 32 bits, and Embree takes at most 2^32 - 2^5 primitives. A larger number is
// an error of the caller.
constexpr size_t kMaxElements = size_t(1) << 31;
// Maximum magnitude of a coordinate. Embree leaves out triangles beyond about 1.8e18, and other code squares lengths in
// float.
constexpr float kMaxCoordinate = 1e18f;

// Throws Error INVALID_ARGUMENT with the name of the mesh if a condition is false.
class Check {
 public:
  explicit Check(const std::string& mesh) : mesh_(mesh) {}
  void that(bool good, const char* text) const {
    if (!good) throw invalid_argument("mesh '" + mesh_ + "': " + text);
  }
  const std::string& mesh() const { return mesh_; }

 private:
  const std::string& mesh_;
};

// Returns whether Embree can trace a vertex. The comparisons are false for NaN, infinity and coordinates that are too
// large.
bool usable(const Vec3& p) {
  return std::fabs(p.x) < kMaxCoordinate && std::fabs(p.y) < kMaxCoordinate && std::fabs(p.z) < kMaxCoordinate;
}

// Throws Error INVALID_ARGUMENT if a count is out of range or an array is missing. Embree's limit for keys holds for
// time keys, too.
void check_counts(const GradusMesh& m, const Check& check) {
  check.that(m.key_count >= 1 && m.key_count <= kMaxShutterKeys, "number of time keys out of range");
  check.that(m.vertex_count < kMaxElements && m.corner_count < kMaxElements && m.triangle_count < kMaxElements &&
                 m.face_count < kMaxElements,
             "too many elements");
  check.that(m.vertex_count * m.key_count < kMaxElements * 4, "too many time keys");
  check.that(m.vertex_count == 0 || m.positions, "positions missing");
  check_shutter_key_count("mesh '" + check.mesh() + "'", m.shutter_key_count);
  check.that(m.vertex_count * m.shutter_key_count < kMaxElements * 4, "too many shutter keys");
  check.that(m.vertex_count == 0 || m.shutter_key_count == 0 || m.shutter_positions, "shutter_positions missing");
  check.that(m.corner_count == 0 || m.corner_vertices, "corner_vertices missing");
  check.that(m.triangle_count == 0 || m.triangle_corners, "triangle_corners missing");
  check.that(m.key_count == 1 || m.key_times, "key_times missing");
  check.that(m.normal_domain <= GRADUS_DOMAIN_CORNER, "unknown domain of normals");
  check.that(m.attribute_count == 0 || m.attributes, "attributes missing");
  check.that(m.edge_count < kMaxElements, "too many edges");
  check.that(m.edge_count == 0 || m.edge_vertices, "edge_vertices missing");
}

void copy_keys(const GradusMesh& m, const Check& check, MeshData* out) {
  out->key_times.assign(m.key_count, 0.0f);
  for (uint32_t k = 0; m.key_times && k < m.key_count; ++k) {
    out->key_times[k] = m.key_times[k];
    check.that(is_finite(m.key_times[k]) && (k == 0 || m.key_times[k] > m.key_times[k - 1]), "key_times do not ascend");
    if (std::fabs(m.key_times[k]) < std::fabs(out->key_times[out->frame_key])) out->frame_key = k;
  }
  out->positions.resize(m.vertex_count * m.key_count + 1);
  if (m.vertex_count) std::memcpy(out->positions.data(), m.positions, m.vertex_count * m.key_count * sizeof(Vec3));
}

void copy_shutter_keys(const GradusMesh& m, MeshData* out) {
  if (m.shutter_key_count == 0 || m.vertex_count == 0) return;
  out->shutter_keys = m.shutter_key_count;
  out->shutter_positions.resize(m.vertex_count * m.shutter_key_count + 1);
  std::memcpy(out->shutter_positions.data(), m.shutter_positions, m.vertex_count * m.shutter_key_count * sizeof(Vec3));
}

bool usable_in_all_keys(const MeshData& mesh, uint32_t vertex) {
  for (size_t k = 0; k < mesh.key_times.size(); ++k)
    if (!usable(mesh.positions[k * mesh.vertex_count + vertex])) return false;
  for (size_t k = 0; k < mesh.shutter_keys; ++k)
    if (!usable(mesh.shutter_positions[k * mesh.vertex_count + vertex])) return false;
  return true;
}

void copy_triangles(const GradusMesh& m, const Check& check, MeshData* out) {
  const size_t count = m.triangle_count * 3;
  out->triangle_corners.assign(m.triangle_corners, m.triangle_corners + count);
  out->triangle_vertices.resize(count);
  for (size_t i = 0; i < count; ++i) {
    check.that(m.triangle_corners[i] < m.corner_count, "a triangle's corner is out of range");
    const int32_t vertex = m.corner_vertices[m.triangle_corners[i]];
    check.that(vertex >= 0 && size_t(vertex) < m.vertex_count, "a corner's vertex is out of range");
    out->triangle_vertices[i] = uint32_t(vertex);
  }
  if (!m.triangle_faces) return;
  out->triangle_faces.resize(m.triangle_count);
  for (size_t i = 0; i < m.triangle_count; ++i) {
    check.that(m.triangle_faces[i] >= 0 && size_t(m.triangle_faces[i]) < m.face_count,
               "a triangle's face is out of range");
    out->triangle_faces[i] = uint32_t(m.triangle_faces[i]);
  }
}

// Drops the triangles with unusable vertices, and sets the bounds of the others.
void drop_unusable(MeshData* mesh) {
  std::vector<bool> good(mesh->vertex_count);
  for (uint32_t i = 0; i < mesh->vertex_count; ++i) good[i] = usable_in_all_keys(*mesh, i);
  for (size_t t = 0; t < mesh->triangle_count; ++t) {
    uint32_t* v = mesh->triangle_vertices.data() + t * 3;
    if (!good[v[0]] || !good[v[1]] || !good[v[2]]) {
      v[0] = v[1] = v[2] = kDroppedVertex;
      ++mesh->dropped_triangles;
    }
  }
  set_bounds(mesh);
}

void copy_face_materials(const GradusMesh& m, MeshData* out) {
  const size_t faces = domain_size(m, GRADUS_DOMAIN_FACE);
  if (!m.face_materials || faces == 0) return;
  out->face_materials.resize(faces);
  // Blender allows any slot number here. The number of slots belongs to the instance, which limits it again.
  for (size_t i = 0; i < faces; ++i) out->face_materials[i] = uint32_t(std::clamp(m.face_materials[i], 0, 32767));
}

// Copies values, with 0 in place of NaN and infinity.
std::vector<float> copy_finite(const float* data, size_t count) {
  std::vector<float> values(data, data + count);
  for (float& v : values)
    if (!is_finite(v)) v = 0.0f;
  return values;
}
// Copies vectors of three values, with 0 in place of NaN and infinity.
std::vector<Vec3> copy_finite_vectors(const float* data, size_t count) {
  std::vector<Vec3> vectors(count);
  for (size_t i = 0; i < count; ++i)
    for (int c = 0; c < 3; ++c) vectors[i][c] = is_finite(data[3 * i + c]) ? data[3 * i + c] : 0.0f;
  return vectors;
}

// Replaces corner normals of length 0 by the smooth normal of the vertex.
void fill_smooth_corners(const GradusMesh& m, MeshData* out) {
  const auto first = std::find(out->normals.begin(), out->normals.end(), Vec3(0.0f));
  if (first == out->normals.end()) return;
  const std::vector<Vec3> smooth = smooth_normals(*out, out->frame_positions());
  for (size_t corner = size_t(first - out->normals.begin()); corner < out->normals.size(); ++corner) {
    if (out->normals[corner] == Vec3(0.0f)) out->normals[corner] = smooth[size_t(m.corner_vertices[corner])];
  }
}

void copy_normals(const GradusMesh& m, MeshData* out) {
  out->normal_domain = GradusDomain(m.normal_domain);
  if (!m.normals && m.normal_domain == GRADUS_DOMAIN_POINT) out->normals = smooth_normals(*out, out->frame_positions());
  if (!m.normals || m.normal_domain == GRADUS_DOMAIN_FACE) return;
  const size_t count = domain_size(m, m.normal_domain);
  out->normals = copy_finite_vectors(m.normals, count);
  if (m.normal_domain == GRADUS_DOMAIN_CORNER) fill_smooth_corners(m, out);
}

void copy_attributes(const GradusMesh& m, const Check& check, MeshData* out) {
  const std::string default_uv = m.default_uv ? m.default_uv : "";
  for (uint32_t i = 0; i < m.attribute_count; ++i) {
    const GradusAttribute& a = m.attributes[i];
    check.that(a.domain <= GRADUS_DOMAIN_CORNER && a.channels >= 1 && a.channels <= 4,
               "an attribute has a wrong domain or channels");
    const size_t count = domain_size(m, a.domain) * a.channels;
    check.that(count == 0 || a.data, "an attribute has no data");
    MeshAttribute copy{a.name ? a.name : "", GradusDomain(a.domain), a.channels, a.is_uv != 0, {}};
    if (count) copy.data = copy_finite(a.data, count);
    out->attributes.push_back(std::move(copy));
    if (a.is_uv && (out->default_uv < 0 || out->attributes.back().name == default_uv)) out->default_uv = int32_t(i);
  }
}

void copy_generated(const GradusMesh& m, MeshData* out) {
  for (int i = 0; i < 3; ++i) {
    if (is_finite(m.generated_location[i])) out->generated_location[i] = m.generated_location[i];
    const bool sized = is_finite(m.generated_size[i]) && m.generated_size[i] != 0.0f;
    out->generated_size[i] = sized ? m.generated_size[i] : 1.0f;
  }
  if (!m.generated_points || m.vertex_count == 0) return;
  out->generated_points = copy_finite_vectors(m.generated_points, m.vertex_count);
}

void copy_dicing(const GradusMesh& m, MeshData* out) {
  constexpr uint32_t kMaxLevels = 16;
  out->dicing_levels = std::min(m.dicing_levels, kMaxLevels);
  out->dicing_rate = is_finite(m.dicing_rate) ? std::max(m.dicing_rate, 0.0f) : 0.0f;
  out->dicing_length = is_finite(m.dicing_length) ? std::max(m.dicing_length, 0.0f) : 0.0f;
  const bool scales = is_finite(m.offscreen_dicing_scale) && m.offscreen_dicing_scale >= 1.0f;
  out->offscreen_dicing_scale = scales ? m.offscreen_dicing_scale : 1.0f;
  out->dicing_tolerance = is_finite(m.dicing_tolerance) ? std::max(m.dicing_tolerance, 1.0f) : 1.0f;
}

void add_edge_values(const GradusMesh& m, const Check& check, MeshData* out) {
  if (m.edge_count == 0) return;
  std::vector<Edge> edges(m.edge_count);
  for (size_t i = 0; i < 2 * m.edge_count; ++i) {
    const int32_t vertex = m.edge_vertices[i];
    check.that(vertex >= 0 && size_t(vertex) < m.vertex_count, "an edge's vertex is out of range");
    edges[i / 2][i % 2] = uint32_t(vertex);
  }
  out->islands = connected_parts(m.vertex_count, edges);
  out->pointiness = pointiness(*out, std::move(edges));
}

uint64_t hash_mesh(const MeshData& mesh) {
  ContentHash hash;
  hash.array(mesh.key_times);
  hash.array(mesh.positions);
  hash.array(mesh.shutter_positions);
  hash.array(mesh.triangle_vertices);
  hash.array(mesh.triangle_corners);
  hash.array(mesh.triangle_faces);
  hash.array(mesh.face_materials);
  hash.value(uint32_t(mesh.normal_domain));
  hash.array(mesh.normals);
  for (const MeshAttribute& a : mesh.attributes) {
    hash.value(a.name);
    hash.value(uint32_t(a.domain) * 16 + a.channels * 2 + (a.is_uv ? 1 : 0));
    hash.array(a.data);
  }
  hash.value(mesh.default_uv);
  for (int i = 0; i < 3; ++i) hash.value(mesh.generated_location[i]), hash.value(mesh.generated_size[i]);
  hash.array(mesh.generated_points);
  if (mesh.dicing_levels > 0) {
    hash.value(mesh.dicing_levels);
    for (const float v : {mesh.dicing_rate, mesh.dicing_length, mesh.offscreen_dicing_scale, mesh.dicing_tolerance})
      hash.value(v);
  }
  hash.array(mesh.pointiness);
  hash.array(mesh.islands);
  return hash.result();
}

uint64_t hash_topology(const MeshData& mesh) {
  ContentHash hash;
  hash.value(mesh.vertex_count);
  hash.array(mesh.triangle_vertices);
  return hash.result();
}

}  // namespace

void set_bounds(MeshData* mesh) {
  mesh->lower = Vec3(kInfinity);
  mesh->upper = Vec3(-kInfinity);
  const Vec3* p = mesh->frame_positions();
  for (const uint32_t v : mesh->triangle_vertices) {
    if (v == kDroppedVertex) continue;
    mesh->lower = glm::min(mesh->lower, p[v]);
    mesh->upper = glm::max(mesh->upper, p[v]);
  }
}

void set_shutter_normals(MeshData* mesh, const CommitMonitor& monitor) {
  if (mesh->shutter_keys == 0 || mesh->normals.empty()) return;
  mesh->shutter_normals = smooth_normals(*mesh, mesh->frame_positions(), monitor);
  for (size_t k = 0; k < mesh->shutter_keys; ++k) {
    const std::vector<Vec3> normals =
        smooth_normals(*mesh, mesh->shutter_positions.data() + k * mesh->vertex_count, monitor);
    mesh->shutter_normals.insert(mesh->shutter_normals.end(), normals.begin(), normals.end());
  }
}

std::shared_ptr<const MeshData> make_mesh(const GradusMesh& desc) {
  auto mesh = std::make_shared<MeshData>();
  mesh->name = desc.name ? desc.name : "";
  const Check check(mesh->name);
  check_counts(desc, check);
  mesh->vertex_count = uint32_t(desc.vertex_count);
  mesh->triangle_count = uint32_t(desc.triangle_count);
  copy_keys(desc, check, mesh.get());
  copy_shutter_keys(desc, mesh.get());
  copy_triangles(desc, check, mesh.get());
  drop_unusable(mesh.get());
  copy_face_materials(desc, mesh.get());
  copy_normals(desc, mesh.get());
  set_shutter_normals(mesh.get());
  copy_attributes(desc, check, mesh.get());
  copy_generated(desc, mesh.get());
  copy_dicing(desc, mesh.get());
  add_edge_values(desc, check, mesh.get());
  mesh->content_hash = hash_mesh(*mesh);
  mesh->topology_hash = hash_topology(*mesh);
  return mesh;
}

}  // namespace gradus::geometry
