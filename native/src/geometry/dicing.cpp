#include "geometry/dicing.h"

#include <algorithm>
#include <unordered_map>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "base/parallel_each.h"
#include "geometry/division_pattern.h"

namespace gradus::geometry {

namespace {

constexpr uint32_t kNoMiddle = UINT32_MAX;
constexpr size_t kGrain = 1024;

// Returns the normal of the mesh at a corner of a triangle. The mesh is shaded smoothly.
const Vec3& corner_normal(const MeshData& mesh, uint32_t triangle, uint32_t k) {
  const size_t corner = size_t{triangle} * 3 + k;
  return mesh.normals[mesh.normal_domain == GRADUS_DOMAIN_POINT ? mesh.triangle_vertices[corner]
                                                                : mesh.triangle_corners[corner]];
}

// The interior edges of a divided triangle, by the points that they connect.
struct InteriorEdges {
  uint32_t first = 0;
  uint32_t count = 0;
  std::array<std::array<uint32_t, 2>, 3> ends{};

  // Returns the edge between two points. Sets *is_new if it has not been asked for before.
  uint32_t find(uint32_t p, uint32_t q, bool* is_new) {
    const std::array<uint32_t, 2> wanted{std::min(p, q), std::max(p, q)};
    for (uint32_t i = 0; i < count; ++i)
      if (ends[i] == wanted) return first + i;
    ends[count] = wanted;
    *is_new = true;
    return first + count++;
  }
};

// Returns the edge of a triangle that two points of a DivisionPattern lie on, or 3 if they lie on none.
uint32_t common_edge(uint32_t p, uint32_t q) {
  for (uint32_t k = 0; k < 3; ++k) {
    const auto is_on = [&](uint32_t point) { return point == k || point == (k + 1) % 3 || point == k + 3; };
    if (is_on(p) && is_on(q)) return k;
  }
  return 3;
}

constexpr uint32_t interior_edges(const DivisionPattern& pattern) { return pattern.count == 4 ? 3 : pattern.count - 1; }

}  // namespace

Dicing::Dicing(std::shared_ptr<const MeshData> mesh, EdgeExcess excess, const CommitMonitor& monitor)
    : mesh_(std::move(mesh)), excess_(std::move(excess)) {
  positions_.assign(mesh_->frame_positions(), mesh_->frame_positions() + mesh_->vertex_count);
  nodes_.resize(mesh_->triangle_count);
  find_edges(monitor);
  find_sharp_edges(monitor);
  parallel_each(edges_.size(), monitor, [&](size_t e) { edges_[e].excess = measure(edges_[e]); });
}

void Dicing::find_edges(const CommitMonitor& monitor) {
  std::unordered_map<uint64_t, uint32_t> known;
  known.reserve(size_t{mesh_->triangle_count} * 3 / 2);
  for (uint32_t t = 0; t < mesh_->triangle_count; ++t) {
    monitor.check_at(t);
    if (mesh_->is_dropped(t)) continue;
    Triangle triangle;
    triangle.base = triangle.node = t;
    triangle.uvs = {Vec2(0.0f), Vec2(1.0f, 0.0f), Vec2(0.0f, 1.0f)};
    for (uint32_t k = 0; k < 3; ++k) triangle.vertices[k] = mesh_->triangle_vertices[size_t{t} * 3 + k];
    for (uint32_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(triangle.vertices[k], triangle.vertices[(k + 1) % 3]);
      const auto [found, is_new] = known.try_emplace(uint64_t{a} << 32 | b, uint32_t(edges_.size()));
      if (is_new) edges_.push_back({a, b, uint32_t(triangles_.size()) * 3 + k, 0.0f});
      triangle.edges[k] = found->second;
    }
    triangles_.push_back(triangle);
  }
}

void Dicing::find_sharp_edges(const CommitMonitor& monitor) {
  if (mesh_->normals.empty() || mesh_->normal_domain == GRADUS_DOMAIN_FACE) return;
  sharp_edges_.assign(mesh_->triangle_count, 0);
  std::vector<uint8_t> is_sharp(edges_.size(), 0);
  const auto normals_of = [&](const Triangle& triangle, uint32_t k) {
    Vec3 a = corner_normal(*mesh_, triangle.base, k), b = corner_normal(*mesh_, triangle.base, (k + 1) % 3);
    if (edges_[triangle.edges[k]].a != triangle.vertices[k]) std::swap(a, b);
    return std::pair(a, b);
  };
  for (const Triangle& triangle : triangles_) {
    monitor.check_at(triangle.base);
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t owner = edges_[triangle.edges[k]].owner;
      if (normals_of(triangle, k) != normals_of(triangles_[owner / 3], owner % 3)) is_sharp[triangle.edges[k]] = 1;
    }
  }
  for (const Triangle& triangle : triangles_)
    for (uint32_t k = 0; k < 3; ++k) sharp_edges_[triangle.base] |= uint8_t(is_sharp[triangle.edges[k]] << k);
}

CurvedPatch Dicing::patch(uint32_t base) const {
  CurvedPatch result;
  result.positions = triangle_positions(*mesh_, base);
  for (uint32_t k = 0; k < 3; ++k) {
    result.normals[k] = safe_unit(corner_normal(*mesh_, base, k), Vec3(0.0f));
    result.is_smooth[k] = (sharp_edges_[base] >> k & 1) == 0;
  }
  return result;
}

Vec3 Dicing::position_at(const Place& place) const {
  const Vec3 flat = interpolate(triangle_positions(*mesh_, place.base), place.uv);
  return is_curved() ? flat + patch(place.base).bend(place.uv) : flat;
}

bool Dicing::is_finest(const Edge& edge) const {
  return triangles_[edge.owner / 3].generation >= 2 * mesh_->dicing_levels;
}

// Returns the excess of an edge, or 0 if it may not be divided.
float Dicing::measure(const Edge& edge) const {
  if (is_finest(edge)) return 0.0f;
  const float excess = excess_(positions_[edge.a], positions_[edge.b]);
  return excess > 0.0f ? std::min(excess, kMaxFloat) : 0.0f;
}

float Dicing::largest_excess() const {
  return tbb::parallel_reduce(
      tbb::blocked_range<size_t>(0, edges_.size(), kGrain), 0.0f,
      [&](const auto& range, float largest) {
        for (size_t e = range.begin(); e < range.end(); ++e) largest = std::max(largest, edges_[e].excess);
        return largest;
      },
      [](float a, float b) { return std::max(a, b); });
}

uint32_t Dicing::divided_edges(const Triangle& triangle, float limit) const {
  uint32_t result = 0;
  for (uint32_t k = 0; k < 3; ++k) result |= uint32_t{edges_[triangle.edges[k]].excess > limit} << k;
  return result;
}

uint64_t Dicing::count_after(float limit) const {
  return tbb::parallel_reduce(
      tbb::blocked_range<size_t>(0, triangles_.size(), kGrain), uint64_t{0},
      [&](const auto& range, uint64_t count) {
        for (size_t t = range.begin(); t < range.end(); ++t)
          count += kDivisionPatterns[division_pattern(divided_edges(triangles_[t], limit), false)].count;
        return count;
      },
      [](uint64_t a, uint64_t b) { return a + b; });
}

uint32_t Dicing::vertex_of(const Triangle& triangle, uint32_t point, const std::vector<uint32_t>& middles) const {
  return point < 3 ? triangle.vertices[point] : middles[triangle.edges[point - 3]];
}

// Chooses the pattern of a triangle. Of two diagonals it takes the shorter one.
uint32_t Dicing::pattern_of(const Triangle& triangle, const std::vector<uint32_t>& middles) const {
  uint32_t edges = 0;
  for (uint32_t k = 0; k < 3; ++k) edges |= uint32_t{middles[triangle.edges[k]] != kNoMiddle} << k;
  if (edges != 3 && edges != 5 && edges != 6) return division_pattern(edges, false);
  const auto length = [&](const std::array<uint8_t, 2>& ends) {
    return glm::distance(positions_[vertex_of(triangle, ends[0], middles)],
                         positions_[vertex_of(triangle, ends[1], middles)]);
  };
  const auto diagonals = diagonals_of(edges);
  return division_pattern(edges, length(diagonals[1]) < length(diagonals[0]));
}

// Adds the vertices in the middles of the edges above the limit. Returns the vertex of each edge, or kNoMiddle.
std::vector<uint32_t> Dicing::add_middles(float limit, const CommitMonitor& monitor) {
  std::vector<uint32_t> middles(edges_.size(), kNoMiddle);
  auto vertex = uint32_t(positions_.size());
  for (size_t e = 0; e < edges_.size(); ++e)
    if (edges_[e].excess > limit) middles[e] = vertex++;
  positions_.resize(vertex);
  places_.resize(vertex - mesh_->vertex_count);
  parallel_each(edges_.size(), monitor, [&](size_t e) {
    if (middles[e] == kNoMiddle) return;
    const Triangle& owner = triangles_[edges_[e].owner / 3];
    const uint32_t k = edges_[e].owner % 3;
    const Place place{owner.base, (owner.uvs[k] + owner.uvs[(k + 1) % 3]) * 0.5f};
    places_[middles[e] - mesh_->vertex_count] = place;
    positions_[middles[e]] = position_at(place);
  });
  return middles;
}

// Finds what the division makes of each triangle, and where it is stored.
std::vector<Dicing::Part> Dicing::plan(const std::vector<uint32_t>& middles, uint32_t first_interior,
                                       const CommitMonitor& monitor, Part* end) const {
  std::vector<Part> parts(triangles_.size());
  parallel_each(parts.size(), monitor, [&](size_t t) {
    parts[t].pattern = uint8_t(pattern_of(triangles_[t], middles));
    for (uint32_t k = 0; k < 3; ++k)
      parts[t].owned |= uint8_t(uint32_t{edges_[triangles_[t].edges[k]].owner == 3 * t + k} << k);
  });
  Part next;
  next.edge = first_interior;
  next.node = uint32_t(nodes_.size());
  for (Part& part : parts) {
    part.triangle = next.triangle;
    part.edge = next.edge;
    part.node = next.node;
    const DivisionPattern& pattern = kDivisionPatterns[part.pattern];
    next.triangle += pattern.count;
    next.edge += interior_edges(pattern);
    if (part.pattern != 0) next.node += pattern.count;
  }
  *end = next;
  return parts;
}

// Makes the parts of a triangle and their edges. Half of a divided edge keeps its number, the other one has the number
// `first_half` and the number of its middle in this division.
void Dicing::divide_triangle(const Triangle& whole, const Part& plan, const std::vector<uint32_t>& middles,
                             uint32_t first_half, uint32_t first_middle, Triangle* parts) {
  const DivisionPattern& pattern = kDivisionPatterns[plan.pattern];
  const std::array<Vec2, 6> uvs{whole.uvs[0],
                                whole.uvs[1],
                                whole.uvs[2],
                                (whole.uvs[0] + whole.uvs[1]) * 0.5f,
                                (whole.uvs[1] + whole.uvs[2]) * 0.5f,
                                (whole.uvs[2] + whole.uvs[0]) * 0.5f};
  InteriorEdges interior;
  interior.first = plan.edge;
  for (uint32_t i = 0; i < pattern.count; ++i) {
    Triangle& part = parts[i];
    const std::array<uint8_t, 3>& points = pattern.parts[i];
    part.base = whole.base;
    part.node = plan.pattern == 0 ? whole.node : plan.node + i;
    part.generation =
        whole.generation +
        std::min<uint32_t>(2, uint32_t(std::count_if(points.begin(), points.end(), [](uint8_t p) { return p > 2; })));
    for (uint32_t k = 0; k < 3; ++k) {
      part.vertices[k] = vertex_of(whole, points[k], middles);
      part.uvs[k] = uvs[points[k]];
    }
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t p = points[k], q = points[(k + 1) % 3], side = common_edge(p, q);
      const uint32_t owner = (plan.triangle + i) * 3 + k;
      if (side == 3) {
        bool is_new = false;
        part.edges[k] = interior.find(p, q, &is_new);
        if (is_new) edges_[part.edges[k]] = {part.vertices[k], part.vertices[(k + 1) % 3], owner, 0.0f};
        continue;
      }
      const uint32_t edge = whole.edges[side];
      const uint32_t end = p > 2 ? q : p;  // a corner of the whole triangle
      const bool is_first = middles[edge] == kNoMiddle || edges_[edge].a == whole.vertices[end];
      part.edges[k] = is_first ? edge : first_half + middles[edge] - first_middle;
      if (plan.owned >> side & 1) edges_[part.edges[k]].owner = owner;
    }
    if (plan.pattern != 0) nodes_[plan.node + i] = {whole.node, 0, 0, uint8_t(i)};
  }
  if (plan.pattern != 0) {
    nodes_[whole.node].first = plan.node;
    nodes_[whole.node].pattern = plan.pattern;
  }
}

void Dicing::divide(float limit, const CommitMonitor& monitor) {
  const auto first_middle = uint32_t(positions_.size()), first_half = uint32_t(edges_.size());
  const std::vector<uint32_t> middles = add_middles(limit, monitor);
  Part end;
  const std::vector<Part> plans = plan(middles, first_half + uint32_t(positions_.size()) - first_middle, monitor, &end);
  monitor.check();
  edges_.resize(end.edge);
  nodes_.resize(end.node);
  parallel_each(middles.size(), monitor, [&](size_t e) {
    if (middles[e] == kNoMiddle) return;
    edges_[first_half + middles[e] - first_middle] = {middles[e], edges_[e].b, 0, 0.0f};
    edges_[e].b = middles[e];
  });
  std::vector<Triangle> divided(end.triangle);
  parallel_each(triangles_.size(), monitor, [&](size_t t) {
    divide_triangle(triangles_[t], plans[t], middles, first_half, first_middle, &divided[plans[t].triangle]);
  });
  triangles_ = std::move(divided);
  parallel_each(edges_.size(), monitor, [&](size_t e) {
    if (e >= first_half || middles[e] != kNoMiddle)
      edges_[e].excess = measure(edges_[e]);
    else if (is_finest(edges_[e]))
      edges_[e].excess = 0.0f;
  });
}

DicingTree Dicing::tree(const CommitMonitor& monitor) const {
  DicingTree tree;
  tree.nodes = nodes_;
  tree.topology_hash = mesh_->topology_hash;
  tree.leaves.resize(triangles_.size());
  parallel_each(triangles_.size(), monitor, [&](size_t t) {
    tree.leaves[t] = triangles_[t].node;
    tree.nodes[triangles_[t].node].first = uint32_t(t);
  });
  return tree;
}

}  // namespace gradus::geometry
