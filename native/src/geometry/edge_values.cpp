#include "geometry/edge_values.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/smooth_normals.h"
#include "geometry/weld.h"

namespace gradus::geometry {

namespace {

// A disjoint-set forest with path compression.
class Forest {
 public:
  explicit Forest(size_t size) : parents_(size), ranks_(size, 0) { std::iota(parents_.begin(), parents_.end(), 0u); }

  uint32_t root(uint32_t i) {
    uint32_t root = i;
    while (parents_[root] != root) root = parents_[root];
    while (parents_[i] != root) i = std::exchange(parents_[i], root);
    return root;
  }

  // Joins two trees. The root of the first one stays a root unless that of the second has a higher rank.
  void join(uint32_t a, uint32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (ranks_[a] < ranks_[b]) std::swap(a, b);
    parents_[b] = a;
    if (ranks_[a] == ranks_[b]) ++ranks_[a];
  }

 private:
  std::vector<uint32_t> parents_, ranks_;
};

// Returns the sum of the unit normals of the vertices at each place, with length 1, at the vertex that stands for it.
std::vector<Vec3> welded_normals(const MeshData& mesh, const std::vector<uint32_t>& welded) {
  const std::vector<Vec3> own = smooth_normals(mesh, mesh.frame_positions());
  std::vector<Vec3> sums(own.size(), Vec3(0.0f));
  for (size_t i = 0; i < own.size(); ++i) sums[welded[i]] += own[i];
  for (Vec3& sum : sums) {
    const float length = glm::length(sum);
    if (length > 0.0f) sum /= length;
  }
  return sums;
}

// Replaces the vertices of edges by those that stand for them, and removes edges that are then equal.
void weld_edges(const std::vector<uint32_t>& welded, std::vector<Edge>* edges) {
  for (Edge& edge : *edges) {
    const auto [low, high] = std::minmax({welded[edge[0]], welded[edge[1]]});
    edge = {low, high};
  }
  std::sort(edges->begin(), edges->end());
  edges->erase(std::unique(edges->begin(), edges->end()), edges->end());
}

Vec3 direction_or_zero(const Vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : Vec3(0.0f);
}

// Returns the angle between the normal and the mean direction of the edges at each vertex, over pi.
std::vector<float> angles(const Vec3* p, const std::vector<Vec3>& normals, const std::vector<Edge>& edges) {
  std::vector<Vec3> sums(normals.size(), Vec3(0.0f));
  std::vector<uint32_t> counts(normals.size(), 0);
  for (const auto& [a, b] : edges) {
    const Vec3 direction = direction_or_zero(p[b] - p[a]);
    sums[a] += direction;
    sums[b] -= direction;
    ++counts[a];
    ++counts[b];
  }
  std::vector<float> values(normals.size(), 0.0f);
  for (size_t i = 0; i < values.size(); ++i) {
    if (counts[i] == 0) continue;
    const float cosine = glm::dot(normals[i], sums[i] / float(counts[i]));
    values[i] = std::acos(std::clamp(cosine, -1.0f, 1.0f)) / kPi;
  }
  return values;
}

// Returns the mean of each value and of those at the other ends of its vertex's edges.
std::vector<float> blurred(const std::vector<float>& values, const std::vector<Edge>& edges) {
  std::vector<float> sums = values;
  std::vector<uint32_t> counts(values.size(), 1);
  for (const auto& [a, b] : edges) {
    sums[a] += values[b];
    sums[b] += values[a];
    ++counts[a];
    ++counts[b];
  }
  for (size_t i = 0; i < sums.size(); ++i) sums[i] /= float(counts[i]);
  return sums;
}

}  // namespace

std::vector<uint32_t> connected_parts(size_t vertex_count, const std::vector<Edge>& edges) {
  Forest forest(vertex_count);
  for (const auto& [a, b] : edges) forest.join(a, b);
  std::vector<uint32_t> parts(vertex_count);
  for (uint32_t i = 0; i < vertex_count; ++i) parts[i] = forest.root(i);
  return parts;
}

std::vector<float> pointiness(const MeshData& mesh, std::vector<Edge> edges) {
  const Vec3* p = mesh.frame_positions();
  const std::vector<uint32_t> welded = weld(p, mesh.vertex_count);
  weld_edges(welded, &edges);
  const std::vector<float> values = blurred(angles(p, welded_normals(mesh, welded), edges), edges);
  std::vector<float> all(mesh.vertex_count);
  for (size_t i = 0; i < all.size(); ++i) all[i] = values[welded[i]];
  return all;
}

}  // namespace gradus::geometry
