// Division of the triangles of a mesh at the edges that are too long.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "base/commit_monitor.h"
#include "geometry/curved_patch.h"
#include "geometry/dicing_tree.h"
#include "geometry/mesh.h"

namespace gradus::geometry {

// Returns by how many times the straight line between two points of a mesh is too long.
using EdgeExcess = std::function<float(const Vec3&, const Vec3&)>;

// The triangles of a mesh while they are divided. An edge is divided at its middle for all its triangles, so that no
// cracks open. Vertices lie on curved patches over the triangles of the mesh, so that the surface does not depend on
// where it is divided.
class Dicing {
 public:
  struct Triangle {
    std::array<uint32_t, 3> vertices, edges;  // an edge leads from its corner to the next
    std::array<Vec2, 3> uvs;                  // barycentric coordinates of the corners on the triangle `base`
    uint32_t base = 0;
    uint32_t node = 0;        // in the tree
    uint32_t generation = 0;  // the base triangle has 2^generation times the area
  };
  // A place on a triangle of the mesh.
  struct Place {
    uint32_t base = 0;
    Vec2 uv{0.0f};
  };

  // All functions that take a monitor throw Error CANCELLED if the commit is cancelled.
  Dicing(std::shared_ptr<const MeshData> mesh, EdgeExcess excess, const CommitMonitor& monitor);

  // Returns the excess of the longest edge that may still be divided.
  float largest_excess() const;
  // Returns the number of triangles after divide().
  uint64_t count_after(float limit) const;
  // Divides the edges whose excess is above the limit, once.
  void divide(float limit, const CommitMonitor& monitor);

  const std::shared_ptr<const MeshData>& mesh() const { return mesh_; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  // Returns the places of the vertices that the mesh does not have.
  const std::vector<Place>& places() const { return places_; }
  // Returns the patch over a triangle of the mesh.
  CurvedPatch patch(uint32_t base) const;
  bool is_curved() const { return !sharp_edges_.empty(); }
  // Returns how the triangles descend from those of the mesh.
  DicingTree tree(const CommitMonitor& monitor) const;

 private:
  struct Edge {
    uint32_t a = 0, b = 0;
    uint32_t owner = 0;  // 3 · triangle + corner: the one that places its middle
    float excess = 0.0f;
  };

  // What a division makes of a triangle: its pattern, and the first of its parts, interior edges and nodes.
  struct Part {
    uint32_t triangle = 0, edge = 0, node = 0;
    uint8_t pattern = 0;
    uint8_t owned = 0;  // bit k: it is the owner of the edge from corner k
  };

  void find_edges(const CommitMonitor& monitor);
  void find_sharp_edges(const CommitMonitor& monitor);
  Vec3 position_at(const Place& place) const;
  bool is_finest(const Edge& edge) const;
  float measure(const Edge& edge) const;
  uint32_t divided_edges(const Triangle& triangle, float limit) const;
  uint32_t vertex_of(const Triangle& triangle, uint32_t point, const std::vector<uint32_t>& middles) const;
  uint32_t pattern_of(const Triangle& triangle, const std::vector<uint32_t>& middles) const;
  std::vector<uint32_t> add_middles(float limit, const CommitMonitor& monitor);
  std::vector<Part> plan(const std::vector<uint32_t>& middles, uint32_t first_interior, const CommitMonitor& monitor,
                         Part* end) const;
  void divide_triangle(const Triangle& whole, const Part& plan, const std::vector<uint32_t>& middles,
                       uint32_t first_half, uint32_t first_middle, Triangle* parts);

  std::shared_ptr<const MeshData> mesh_;
  EdgeExcess excess_;
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
  std::vector<Vec3> positions_;       // of all vertices in the rendered frame
  std::vector<Place> places_;         // of vertices after those of the mesh
  std::vector<uint8_t> sharp_edges_;  // bit k of each base triangle: the edge from corner k is not smooth
  std::vector<DicingTree::Node> nodes_;
};

}  // namespace gradus::geometry
