#include "geometry/diced_mesh.h"

#include "base/hash.h"
#include "base/parallel_each.h"

namespace gradus::geometry {

namespace {

// Makes the arrays of the diced mesh from those of the mesh before.
class Assembly {
 public:
  Assembly(const Dicing& dicing, const CommitMonitor& monitor)
      : dicing_(dicing), monitor_(monitor), mesh_(*dicing.mesh()), out_(std::make_shared<MeshData>(header_of(mesh_))) {}

  std::shared_ptr<const MeshData> run() {
    out_->vertex_count = mesh_.vertex_count + uint32_t(dicing_.places().size());
    set_triangles();
    set_positions();
    if (dicing_.is_curved()) set_normals();
    for (const MeshAttribute& attribute : mesh_.attributes) out_->attributes.push_back(divide(attribute));
    out_->generated_points = at_vertices(mesh_.generated_points);
    out_->pointiness = at_vertices(mesh_.pointiness);
    set_islands();
    monitor_.check();
    set_bounds(out_.get());
    set_shutter_normals(out_.get(), monitor_);
    set_tree();
    return out_;
  }

 private:
  // Returns a copy without the arrays that change.
  static MeshData header_of(const MeshData& mesh) {
    MeshData header;
    header.name = mesh.name;
    header.key_times = mesh.key_times;
    header.frame_key = mesh.frame_key;
    header.shutter_keys = mesh.shutter_keys;
    header.face_materials = mesh.face_materials;
    header.normal_domain = mesh.normal_domain;
    header.default_uv = mesh.default_uv;
    header.generated_location = mesh.generated_location;
    header.generated_size = mesh.generated_size;
    return header;
  }

  std::array<uint32_t, 3> vertices_of(uint32_t base) const {
    const uint32_t* v = &mesh_.triangle_vertices[size_t{base} * 3];
    return {v[0], v[1], v[2]};
  }

  void set_triangles() {
    const std::vector<Dicing::Triangle>& triangles = dicing_.triangles();
    out_->triangle_count = uint32_t(triangles.size());
    out_->triangle_vertices.resize(triangles.size() * 3);
    out_->triangle_corners.resize(triangles.size() * 3);
    out_->triangle_faces.resize(triangles.size());
    parallel_each(triangles.size(), monitor_, [&](size_t t) {
      for (size_t k = 0; k < 3; ++k) {
        out_->triangle_vertices[3 * t + k] = triangles[t].vertices[k];
        out_->triangle_corners[3 * t + k] = uint32_t(3 * t + k);
      }
      out_->triangle_faces[t] = mesh_.face(triangles[t].base);
    });
  }

  void set_positions() {
    const std::vector<Dicing::Place>& places = dicing_.places();
    std::vector<Vec3> bends(dicing_.is_curved() ? places.size() : 0);
    parallel_each(bends.size(), monitor_,
                  [&](size_t i) { bends[i] = dicing_.patch(places[i].base).bend(places[i].uv); });
    out_->positions = divide_keys(mesh_.positions, mesh_.key_times.size(), bends);
    out_->shutter_positions = divide_keys(mesh_.shutter_positions, mesh_.shutter_keys, bends);
  }

  // Returns the positions of all vertices at all keys, and a padding.
  std::vector<Vec3> divide_keys(const std::vector<Vec3>& positions, size_t keys, const std::vector<Vec3>& bends) const {
    if (keys == 0) return positions;
    std::vector<Vec3> divided(keys * out_->vertex_count + 1, Vec3(0.0f));
    for (size_t key = 0; key < keys; ++key) {
      const Vec3* from = positions.data() + key * mesh_.vertex_count;
      Vec3* to = divided.data() + key * out_->vertex_count;
      set_vertices(from, to);
      parallel_each(bends.size(), monitor_, [&](size_t i) { to[mesh_.vertex_count + i] += bends[i]; });
    }
    return divided;
  }

  // Copies values of vertices and interpolates those of new ones.
  template <class T>
  void set_vertices(const T* from, T* to) const {
    std::copy_n(from, mesh_.vertex_count, to);
    const std::vector<Dicing::Place>& places = dicing_.places();
    parallel_each(places.size(), monitor_, [&](size_t i) {
      const auto [a, b, c] = vertices_of(places[i].base);
      to[mesh_.vertex_count + i] = interpolate(std::array<T, 3>{from[a], from[b], from[c]}, places[i].uv);
    });
  }

  template <class T>
  std::vector<T> at_vertices(const std::vector<T>& values) const {
    std::vector<T> divided(values.empty() ? 0 : out_->vertex_count);
    if (!values.empty()) set_vertices(values.data(), divided.data());
    return divided;
  }

  void set_islands() {
    out_->islands = mesh_.islands;
    if (mesh_.islands.empty()) return;
    for (const Dicing::Place& place : dicing_.places())
      out_->islands.push_back(mesh_.islands[vertices_of(place.base)[0]]);
  }

  void set_normals() {
    if (mesh_.normal_domain == GRADUS_DOMAIN_POINT) {
      const std::vector<Dicing::Place>& places = dicing_.places();
      out_->normals = mesh_.normals;
      out_->normals.resize(out_->vertex_count);
      parallel_each(places.size(), monitor_, [&](size_t i) {
        out_->normals[mesh_.vertex_count + i] = dicing_.patch(places[i].base).normal(places[i].uv);
      });
      return;
    }
    out_->normals.resize(size_t{out_->triangle_count} * 3);
    parallel_each(out_->triangle_count, monitor_, [&](size_t t) {
      const Dicing::Triangle& triangle = dicing_.triangles()[t];
      const CurvedPatch patch = dicing_.patch(triangle.base);
      for (size_t k = 0; k < 3; ++k) out_->normals[3 * t + k] = patch.normal(triangle.uvs[k]);
    });
  }

  MeshAttribute divide(const MeshAttribute& attribute) const {
    MeshAttribute divided = attribute;
    const std::vector<float>& data = attribute.data;
    const uint32_t channels = attribute.channels;
    // Interpolates the elements that belong to the corners of a triangle.
    const auto set = [&](const std::array<uint32_t, 3>& elements, const Vec2& uv, float* to) {
      for (uint32_t c = 0; c < channels; ++c) {
        std::array<float, 3> values;
        for (size_t k = 0; k < 3; ++k) values[k] = data[size_t{elements[k]} * channels + c];
        to[c] = interpolate(values, uv);
      }
    };
    if (attribute.domain == GRADUS_DOMAIN_POINT) {
      const std::vector<Dicing::Place>& places = dicing_.places();
      divided.data.resize(size_t{out_->vertex_count} * channels);
      parallel_each(places.size(), monitor_, [&](size_t i) {
        set(vertices_of(places[i].base), places[i].uv, &divided.data[(mesh_.vertex_count + i) * channels]);
      });
    }
    if (attribute.domain == GRADUS_DOMAIN_CORNER) {
      divided.data.resize(size_t{out_->triangle_count} * 3 * channels);
      parallel_each(out_->triangle_count, monitor_, [&](size_t t) {
        const Dicing::Triangle& triangle = dicing_.triangles()[t];
        const uint32_t* corners = &mesh_.triangle_corners[size_t{triangle.base} * 3];
        for (size_t k = 0; k < 3; ++k)
          set({corners[0], corners[1], corners[2]}, triangle.uvs[k], &divided.data[(3 * t + k) * channels]);
      });
    }
    return divided;
  }

  void set_tree() {
    const auto tree = std::make_shared<DicingTree>(dicing_.tree(monitor_));
    std::vector<uint8_t> patterns;
    patterns.reserve(tree->nodes.size());
    for (const DicingTree::Node& node : tree->nodes) patterns.push_back(node.pattern);
    ContentHash hash;
    hash.value(mesh_.topology_hash);
    hash.array(patterns);
    out_->topology_hash = hash.result();
    hash.value(mesh_.content_hash);
    out_->content_hash = hash.result();
    out_->dicing = tree;
  }

  const Dicing& dicing_;
  const CommitMonitor& monitor_;
  const MeshData& mesh_;
  std::shared_ptr<MeshData> out_;
};

}  // namespace

std::shared_ptr<const MeshData> diced_mesh(const Dicing& dicing, const CommitMonitor& monitor) {
  return Assembly(dicing, monitor).run();
}

}  // namespace gradus::geometry
