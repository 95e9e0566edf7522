#include "geometry/tangent_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <numeric>
#include <span>
#include <tuple>

#include "base/fpu.h"
#include "base/parallel_each.h"

namespace gradus::geometry {

namespace {

// Returns the unit vector, or 0 if v has no direction.
Vec3 unit_or_zero(const Vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f && is_finite(length) ? v / length : Vec3(0.0f);
}

// Returns the unit vector of v projected to the plane with this unit normal.
Vec3 within_plane(const Vec3& v, const Vec3& normal) { return unit_or_zero(v - normal * glm::dot(normal, v)); }

// A corner of a triangle, with the data that decide which corners share a tangent.
struct Corner {
  uint32_t vertex;
  Vec3 normal;
  Vec2 uv;
  float handedness;  // ±1; 0: the triangle has no area in the UV map
  Vec4 tangent;      // weighted by the angle at the corner; w unused

  // Corners at the same place are one corner of the surface.
  auto place() const { return std::tuple(vertex, normal.x, normal.y, normal.z, uv.x, uv.y); }
};

// Returns the direction of increasing u in the triangle, not normalised, with the handedness in w. It is 0 if the
// triangle has no area in the UV map.
Vec4 direction_of_u(const std::array<Vec3, 3>& p, const std::array<Vec4, 3>& uv) {
  const Vec2 d1 = Vec2(uv[1]) - Vec2(uv[0]), d2 = Vec2(uv[2]) - Vec2(uv[0]);
  const float area = d1.x * d2.y - d2.x * d1.y;
  if (area == 0.0f || !is_finite(area)) return Vec4(0.0f);
  const float handedness = area > 0.0f ? 1.0f : -1.0f;
  return Vec4(((p[1] - p[0]) * d2.y - (p[2] - p[0]) * d1.y) * handedness, handedness);
}

// Returns the angle of the triangle at corner k, projected along the normal.
float angle_at(const std::array<Vec3, 3>& p, int k, const Vec3& normal) {
  const Vec3 a = within_plane(p[(k + 1) % 3] - p[k], normal), b = within_plane(p[(k + 2) % 3] - p[k], normal);
  return std::acos(std::clamp(glm::dot(a, b), -1.0f, 1.0f));
}

void add_corners(const MeshData& mesh, const MeshAttribute& uv, uint32_t triangle, Corner* out) {
  const std::array<Vec3, 3> p = triangle_positions(mesh, triangle);
  const std::array<Vec4, 3> map = corner_values(mesh, uv, triangle);
  std::array<Vec3, 3> normals;
  if (!triangle_normals(mesh, triangle, &normals)) normals.fill(glm::cross(p[1] - p[0], p[2] - p[0]));
  const Vec4 along_u = direction_of_u(p, map);
  for (int k = 0; k < 3; ++k) {
    const Vec3 n = unit_or_zero(normals[k]);
    const Vec3 tangent = within_plane(Vec3(along_u), n) * angle_at(p, k, n);
    out[k] = {mesh.triangle_vertices[size_t(triangle) * 3 + k], n, Vec2(map[k]), along_u.w, Vec4(tangent, 0.0f)};
  }
}

std::vector<Corner> corners_of(const MeshData& mesh, const MeshAttribute& uv, const CommitMonitor& monitor) {
  std::vector<Corner> corners(size_t(mesh.triangle_count) * 3,
                              Corner{kDroppedVertex, Vec3(0.0f), Vec2(0.0f), 0.0f, Vec4(0.0f)});
  parallel_each(mesh.triangle_count, monitor, [&](size_t index) {
    const FlushDenormals flush;
    const auto triangle = uint32_t(index);
    if (!mesh.is_dropped(triangle)) add_corners(mesh, uv, triangle, &corners[size_t(triangle) * 3]);
  });
  return corners;
}

// Returns the indices of the corners in an order in which corners at the same place are consecutive. Equal corners are
// ordered by index, so that sums are bitwise equal on every machine.
std::vector<uint32_t> by_place(const std::vector<Corner>& corners, uint32_t vertex_count,
                               const CommitMonitor& monitor) {
  std::vector<uint32_t> first(size_t(vertex_count) + 1, 0);
  for (const Corner& c : corners)
    if (c.vertex != kDroppedVertex) ++first[c.vertex + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<uint32_t> order(first.back()), next(first.begin(), first.end() - 1);
  for (uint32_t i = 0; i < corners.size(); ++i)
    if (corners[i].vertex != kDroppedVertex) order[next[corners[i].vertex]++] = i;
  monitor.check();
  parallel_each(vertex_count, monitor, [&](size_t v) {
    std::sort(order.begin() + first[v], order.begin() + first[v + 1], [&](uint32_t a, uint32_t b) {
      return std::tuple(corners[a].place(), a) < std::tuple(corners[b].place(), b);
    });
  });
  return order;
}

// Divides the corners at one place into those that share a tangent: corners of triangles of the same handedness that
// meet at an edge there. A triangle without handedness joins one that it meets.
class CornerGroups {
 public:
  // places: the number of each corner's place.
  CornerGroups(const std::vector<Corner>& corners, const std::vector<uint32_t>& places)
      : corners_(corners), places_(places) {}

  // Returns for each of the corners, which are at one place, the position of the first one of its group.
  const std::vector<uint32_t>& find(std::span<const uint32_t> at_place) {
    first_.resize(at_place.size());
    std::iota(first_.begin(), first_.end(), 0u);
    ends_.clear();
    for (uint32_t k = 0; k < at_place.size(); ++k) {
      const uint32_t triangle = at_place[k] / 3, corner = at_place[k] % 3;
      for (const uint32_t other : {(corner + 1) % 3, (corner + 2) % 3})
        ends_.push_back({places_[triangle * 3 + other], handedness(at_place[k]), k});
    }
    std::sort(ends_.begin(), ends_.end());
    for (size_t i = 1; i < ends_.size(); ++i) {
      const End &a = ends_[i - 1], &b = ends_[i];
      if (a.place == b.place && a.handedness == b.handedness) join(a.corner, b.corner);
    }
    join_flat(at_place);
    for (uint32_t k = 0; k < at_place.size(); ++k) first_[k] = root(k);
    return first_;
  }

 private:
  // The far end of an edge of a triangle.
  struct End {
    uint32_t place;
    float handedness;
    uint32_t corner;
    auto operator<=>(const End&) const = default;
  };

  float handedness(uint32_t corner) const { return corners_[corner].handedness; }

  // Joins the corners without handedness to one that they meet, or to those joined before.
  void join_flat(std::span<const uint32_t> at_place) {
    for (size_t i = 1; i < ends_.size(); ++i) {
      const uint32_t a = ends_[i - 1].corner, b = ends_[i].corner;
      if (ends_[i - 1].place != ends_[i].place) continue;
      const bool is_flat = handedness(at_place[a]) == 0.0f, other_is_flat = handedness(at_place[b]) == 0.0f;
      if (is_flat != other_is_flat && root(is_flat ? a : b) == (is_flat ? a : b)) join(a, b);
    }
  }

  uint32_t root(uint32_t k) const {
    while (first_[k] != k) k = first_[k];
    return k;
  }
  void join(uint32_t a, uint32_t b) {
    const auto [first, last] = std::minmax({root(a), root(b)});
    first_[last] = first;
  }

  const std::vector<Corner>& corners_;
  const std::vector<uint32_t>& places_;
  std::vector<uint32_t> first_;
  std::vector<End> ends_;
};

}  // namespace

std::array<Vec4, 3> TangentField::corners(uint32_t triangle) const {
  const uint32_t* i = corner_tangents.data() + size_t(triangle) * 3;
  return {tangents[i[0]], tangents[i[1]], tangents[i[2]]};
}

std::shared_ptr<const TangentField> make_tangents(const std::shared_ptr<const MeshData>& mesh, const MeshAttribute& uv,
                                                  const CommitMonitor& monitor) {
  const std::vector<Corner> corners = corners_of(*mesh, uv, monitor);
  const std::vector<uint32_t> order = by_place(corners, mesh->vertex_count, monitor);
  std::vector<uint32_t> places(corners.size(), 0), starts;
  for (uint32_t i = 0; i < order.size(); ++i) {
    monitor.check_at(i);
    if (i == 0 || corners[order[i]].place() != corners[order[i - 1]].place()) starts.push_back(i);
    places[order[i]] = uint32_t(starts.size()) - 1;
  }
  starts.push_back(uint32_t(order.size()));
  auto field = std::make_shared<TangentField>();
  field->mesh = mesh;
  field->uv = &uv;
  field->corner_tangents.resize(corners.size());
  CornerGroups groups(corners, places);
  for (size_t place = 0; place + 1 < starts.size(); ++place) {
    monitor.check_at(place);
    const std::span<const uint32_t> at_place(order.data() + starts[place], starts[place + 1] - starts[place]);
    const std::vector<uint32_t>& first = groups.find(at_place);
    for (uint32_t k = 0; k < at_place.size(); ++k) {
      const Corner& corner = corners[at_place[k]];
      if (first[k] == k) {
        field->corner_tangents[at_place[k]] = uint32_t(field->tangents.size());
        field->tangents.emplace_back(Vec3(0.0f), corner.handedness);
      }
      const uint32_t tangent = field->corner_tangents[at_place[first[k]]];
      field->corner_tangents[at_place[k]] = tangent;
      field->tangents[tangent] += corner.tangent;
      if (field->tangents[tangent].w == 0.0f) field->tangents[tangent].w = corner.handedness;
    }
  }
  for (Vec4& t : field->tangents) t = Vec4(unit_or_zero(Vec3(t)), t.w);
  field->tangents.shrink_to_fit();
  return field;
}

}  // namespace gradus::geometry
