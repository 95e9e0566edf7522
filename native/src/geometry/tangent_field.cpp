#include "geometry/tangent_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include <tbb/parallel_for.h>

#include "base/fpu.h"

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

  auto place() const { return std::tuple(normal.x, normal.y, normal.z, uv.x, uv.y); }
  // Order of the corners at a vertex. Corners without handedness come last, after the neighbours whose tangent they
  // take.
  auto key() const { return std::tuple_cat(place(), std::tuple(handedness == 0.0f ? 2.0f : -handedness)); }
  // Returns whether this corner shares the tangent of an earlier corner `o`.
  bool joins(const Corner& o) const {
    return vertex == o.vertex && place() == o.place() && (handedness == o.handedness || handedness == 0.0f);
  }
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

std::vector<Corner> corners_of(const MeshData& mesh, const MeshAttribute& uv) {
  std::vector<Corner> corners(size_t(mesh.triangle_count) * 3,
                              Corner{kDroppedVertex, Vec3(0.0f), Vec2(0.0f), 0.0f, Vec4(0.0f)});
  tbb::parallel_for(uint32_t(0), mesh.triangle_count, [&](uint32_t triangle) {
    const FlushDenormals flush;
    if (!mesh.is_dropped(triangle)) add_corners(mesh, uv, triangle, &corners[size_t(triangle) * 3]);
  });
  return corners;
}

// Returns the indices of the corners in an order in which corners that share a tangent are consecutive. Equal corners
// are ordered by index, so that sums are bitwise equal on every machine.
std::vector<uint32_t> grouped(const std::vector<Corner>& corners, uint32_t vertex_count) {
  std::vector<uint32_t> first(size_t(vertex_count) + 1, 0);
  for (const Corner& c : corners)
    if (c.vertex != kDroppedVertex) ++first[c.vertex + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<uint32_t> order(first.back()), next(first.begin(), first.end() - 1);
  for (uint32_t i = 0; i < corners.size(); ++i)
    if (corners[i].vertex != kDroppedVertex) order[next[corners[i].vertex]++] = i;
  tbb::parallel_for(uint32_t(0), vertex_count, [&](uint32_t v) {
    std::sort(order.begin() + first[v], order.begin() + first[v + 1], [&](uint32_t a, uint32_t b) {
      return std::tuple(corners[a].key(), a) < std::tuple(corners[b].key(), b);
    });
  });
  return order;
}

}  // namespace

std::array<Vec4, 3> TangentField::corners(uint32_t triangle) const {
  const uint32_t* i = corner_tangents.data() + size_t(triangle) * 3;
  return {tangents[i[0]], tangents[i[1]], tangents[i[2]]};
}

std::shared_ptr<const TangentField> make_tangents(const std::shared_ptr<const MeshData>& mesh,
                                                  const MeshAttribute& uv) {
  const std::vector<Corner> corners = corners_of(*mesh, uv);
  auto field = std::make_shared<TangentField>();
  field->mesh = mesh;
  field->uv = &uv;
  field->corner_tangents.resize(corners.size());
  const Corner* last = nullptr;
  for (const uint32_t i : grouped(corners, mesh->vertex_count)) {
    const Corner& corner = corners[i];
    const bool shared = last && corner.joins(*last);
    if (!shared) field->tangents.emplace_back(Vec3(0.0f), corner.handedness);
    field->corner_tangents[i] = uint32_t(field->tangents.size()) - 1;
    field->tangents.back() += corner.tangent;
    if (!shared) last = &corner;
  }
  for (Vec4& t : field->tangents) t = Vec4(unit_or_zero(Vec3(t)), t.w);
  field->tangents.shrink_to_fit();
  return field;
}

}  // namespace gradus::geometry
