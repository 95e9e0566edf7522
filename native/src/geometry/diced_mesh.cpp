#include "geometry/diced_mesh.h"

#include <unordered_map>

#include "base/hash.h"
#include "geometry/plane.h"

namespace gradus::geometry {

namespace {

// An edge of the mesh, and the elements of the normals at its ends as its first triangle has them.
struct DividedEdge {
  uint32_t a = 0, b = 0;
  uint32_t normal_a = 0, normal_b = 0;
  bool is_smooth = true;  // all its triangles have the same normals there
};

// The corners of the four triangles by the corners of the divided one: 0, 1 and 2 are its corners, 3, 4 and 5 the
// middles of its edges from these.
constexpr uint32_t kQuarters[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}};

// Divides all triangles of a mesh once.
class Division {
 public:
  explicit Division(const MeshData& mesh) : mesh_(mesh), out_(std::make_shared<MeshData>(mesh)) { find_edges(); }

  std::shared_ptr<const MeshData> run() {
    bend_edges();
    divide_positions(mesh_.key_times.size(), mesh_.positions, &out_->positions);
    divide_positions(mesh_.shutter_keys, mesh_.shutter_positions, &out_->shutter_positions);
    out_->vertex_count = vertex_count();
    divide_triangles();
    divide_values();
    divide_normals();
    set_bounds(out_.get());
    set_shutter_normals(out_.get());
    out_->content_hash = next_hash(mesh_.content_hash);
    out_->topology_hash = next_hash(mesh_.topology_hash);
    return out_;
  }

 private:
  static uint64_t next_hash(uint64_t hash) {
    ContentHash next;
    next.value(hash);
    next.value(uint32_t{4});
    return next.result();
  }

  uint32_t vertex_count() const { return mesh_.vertex_count + uint32_t(edges_.size()); }
  uint32_t vertex(uint32_t triangle, uint32_t k) const { return mesh_.triangle_vertices[size_t{triangle} * 3 + k]; }
  uint32_t corner(uint32_t triangle, uint32_t k) const { return mesh_.triangle_corners[size_t{triangle} * 3 + k]; }
  bool has_normals() const { return !mesh_.normals.empty() && mesh_.normal_domain != GRADUS_DOMAIN_FACE; }
  bool by_vertex() const { return mesh_.normal_domain == GRADUS_DOMAIN_POINT; }
  uint32_t normal_element(uint32_t triangle, uint32_t k) const {
    return by_vertex() ? vertex(triangle, k) : corner(triangle, k);
  }

  void find_edges() {
    std::unordered_map<uint64_t, uint32_t> known;
    known.reserve(size_t{mesh_.triangle_count} * 3 / 2);
    middles_.assign(size_t{mesh_.triangle_count} * 3, kDroppedVertex);
    for (uint32_t t = 0; t < mesh_.triangle_count; ++t) {
      for (uint32_t k = 0; k < 3 && !mesh_.is_dropped(t); ++k) {
        DividedEdge edge{vertex(t, k), vertex(t, (k + 1) % 3), normal_element(t, k), normal_element(t, (k + 1) % 3)};
        if (edge.a > edge.b) std::swap(edge.a, edge.b), std::swap(edge.normal_a, edge.normal_b);
        const auto [found, is_new] = known.try_emplace(uint64_t{edge.a} << 32 | edge.b, uint32_t(edges_.size()));
        middles_[size_t{t} * 3 + k] = found->second;
        if (is_new)
          edges_.push_back(edge);
        else if (has_normals() && !has_same_normals(edges_[found->second], edge))
          edges_[found->second].is_smooth = false;
      }
    }
  }

  bool has_same_normals(const DividedEdge& x, const DividedEdge& y) const {
    return mesh_.normals[x.normal_a] == mesh_.normals[y.normal_a] &&
           mesh_.normals[x.normal_b] == mesh_.normals[y.normal_b];
  }

  // Computes how far the middle of each edge lies from the straight line.
  void bend_edges() {
    bends_.assign(edges_.size(), Vec3(0.0f));
    if (!has_normals()) return;
    for (size_t i = 0; i < edges_.size(); ++i) {
      const DividedEdge& e = edges_[i];
      if (!e.is_smooth) continue;
      const Vec3 along = mesh_.frame_positions()[e.b] - mesh_.frame_positions()[e.a];
      const Vec3 na = safe_unit(mesh_.normals[e.normal_a], Vec3(0.0f));
      const Vec3 nb = safe_unit(mesh_.normals[e.normal_b], Vec3(0.0f));
      bends_[i] = (nb * glm::dot(along, nb) - na * glm::dot(along, na)) * 0.125f;
    }
  }

  void divide_positions(size_t keys, const std::vector<Vec3>& from, std::vector<Vec3>* to) const {
    if (keys == 0) return;
    to->clear();
    to->reserve(keys * vertex_count() + 1);
    for (size_t key = 0; key < keys; ++key) {
      const Vec3* p = from.data() + key * mesh_.vertex_count;
      to->insert(to->end(), p, p + mesh_.vertex_count);
      for (size_t i = 0; i < edges_.size(); ++i) to->push_back((p[edges_[i].a] + p[edges_[i].b]) * 0.5f + bends_[i]);
    }
    to->emplace_back(0.0f);
  }

  // Makes the triangles. Each has corners of its own.
  void divide_triangles() {
    out_->triangle_vertices.clear();
    out_->triangle_corners.clear();
    out_->triangle_faces.clear();
    out_->dropped_triangles = 0;
    for (uint32_t t = 0; t < mesh_.triangle_count; ++t) {
      if (mesh_.is_dropped(t)) continue;
      for (const auto& quarter : kQuarters) {
        for (const uint32_t k : quarter) {
          out_->triangle_vertices.push_back(k < 3 ? vertex(t, k)
                                                  : mesh_.vertex_count + middles_[size_t{t} * 3 + k - 3]);
          out_->triangle_corners.push_back(uint32_t(out_->triangle_corners.size()));
        }
        out_->triangle_faces.push_back(mesh_.face(t));
      }
    }
    out_->triangle_count = uint32_t(out_->triangle_faces.size());
  }

  // Appends the means of the ends of edges to values of vertices.
  template <class T>
  void divide_vertex_values(std::vector<T>* values) const {
    if (values->empty()) return;
    for (const DividedEdge& e : edges_) values->push_back(((*values)[e.a] + (*values)[e.b]) * 0.5f);
  }

  void divide_values() {
    divide_vertex_values(&out_->generated_points);
    divide_vertex_values(&out_->pointiness);
    for (const DividedEdge& e : edges_)
      if (!out_->islands.empty()) out_->islands.push_back(out_->islands[e.a]);
    for (MeshAttribute& attribute : out_->attributes) divide_attribute(&attribute);
  }

  void divide_attribute(MeshAttribute* attribute) const {
    const uint32_t channels = attribute->channels;
    std::vector<float>& data = attribute->data;
    if (attribute->domain == GRADUS_DOMAIN_POINT) {
      for (const DividedEdge& e : edges_)
        for (uint32_t c = 0; c < channels; ++c)
          data.push_back((data[size_t{e.a} * channels + c] + data[size_t{e.b} * channels + c]) * 0.5f);
    }
    if (attribute->domain != GRADUS_DOMAIN_CORNER) return;
    std::vector<float> divided;
    divided.reserve(out_->triangle_corners.size() * channels);
    for_each_corner([&](uint32_t t, uint32_t k) {
      const float *a = data.data() + size_t{corner(t, k % 3)} * channels, *b = a;
      if (k >= 3) b = data.data() + size_t{corner(t, (k + 1) % 3)} * channels;
      for (uint32_t c = 0; c < channels; ++c) divided.push_back((a[c] + b[c]) * 0.5f);
    });
    data = std::move(divided);
  }

  // Returns the normal in the middle of an edge from p to q with the normals a and b at its ends.
  static Vec3 middle_normal(const Vec3& along, const Vec3& a, const Vec3& b) {
    const float square = glm::dot(along, along);
    const Vec3 sum = a + b;
    const Vec3 mirrored = square > 0.0f ? sum - along * (2.0f * glm::dot(along, sum) / square) : sum;
    return safe_unit(sum * 0.25f + safe_unit(mirrored, sum * 0.5f) * 0.5f, a);
  }

  void divide_normals() {
    if (!has_normals()) return;
    const Vec3* p = mesh_.frame_positions();
    if (by_vertex()) {
      for (const DividedEdge& e : edges_)
        out_->normals.push_back(middle_normal(p[e.b] - p[e.a], mesh_.normals[e.a], mesh_.normals[e.b]));
      return;
    }
    out_->normals.clear();
    for_each_corner([&](uint32_t t, uint32_t k) {
      const Vec3& a = mesh_.normals[corner(t, k % 3)];
      const uint32_t next = (k + 1) % 3;
      out_->normals.push_back(
          k < 3 ? a : middle_normal(p[vertex(t, next)] - p[vertex(t, k % 3)], a, mesh_.normals[corner(t, next)]));
    });
  }

  // Calls visit(triangle, k) for the corners of the new triangles in order, where k is as in kQuarters.
  template <class Visit>
  void for_each_corner(const Visit& visit) const {
    for (uint32_t t = 0; t < mesh_.triangle_count; ++t)
      for (const auto& quarter : kQuarters)
        for (const uint32_t k : quarter)
          if (!mesh_.is_dropped(t)) visit(t, k);
  }

  const MeshData& mesh_;
  std::shared_ptr<MeshData> out_;
  std::vector<DividedEdge> edges_;
  std::vector<uint32_t> middles_;  // 3 per triangle: the edge from each corner
  std::vector<Vec3> bends_;        // by edge
};

}  // namespace

std::shared_ptr<const MeshData> diced_mesh(const std::shared_ptr<const MeshData>& mesh, uint32_t levels) {
  std::shared_ptr<const MeshData> diced = mesh;
  for (uint32_t i = 0; i < levels; ++i) diced = Division(*diced).run();
  return diced;
}

}  // namespace gradus::geometry
