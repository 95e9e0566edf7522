#include "geometry/tangent_field.h"

#include <array>

#include <gtest/gtest.h>

#include "gradus/gradus.h"

namespace gradus::tangent_field_test {
namespace {

// Returns smooth triangles with shared vertices, with a UV map by corner.
std::shared_ptr<const geometry::MeshData> make(const std::vector<float>& positions, const std::vector<int32_t>& corners,
                                               const std::vector<float>& uv) {
  std::vector<uint32_t> triangles(corners.size());
  for (uint32_t i = 0; i < triangles.size(); ++i) triangles[i] = i;
  GradusAttribute map{};
  map.name = "UVMap";
  map.domain = GRADUS_DOMAIN_CORNER;
  map.channels = 2;
  map.is_uv = 1;
  map.data = uv.data();
  GradusMesh desc{};
  desc.struct_size = sizeof(desc);
  desc.key_count = 1;
  desc.vertex_count = positions.size() / 3;
  desc.positions = positions.data();
  desc.corner_count = corners.size();
  desc.corner_vertices = corners.data();
  desc.triangle_count = corners.size() / 3;
  desc.triangle_corners = triangles.data();
  desc.normal_domain = GRADUS_DOMAIN_POINT;
  desc.attributes = &map;
  desc.attribute_count = 1;
  desc.default_uv = "UVMap";
  return geometry::make_mesh(desc);
}

void expect_tangent(const Vec4& found, const Vec3& direction, float handedness) {
  EXPECT_NEAR(glm::length(Vec3(found) - glm::normalize(direction)), 0.0f, 1e-6f);
  EXPECT_EQ(found.w, handedness);
}

// A roof over the y axis, mapped from above: on its ridge the normal points up and both sides share the tangent.
TEST(TangentField, SharedAcrossAnEdge) {
  const auto mesh =
      make({0, 0, 1, 0, 1, 1, 1, 0, 0, -1, 0, 0}, {0, 2, 1, 0, 1, 3}, {0, 0, 1, 0, 0, 1, 0, 0, 0, 1, -1, 0});
  const auto field = geometry::make_tangents(mesh, *geometry::default_uv_map(*mesh));
  const auto right = field->corners(0), left = field->corners(1);
  expect_tangent(right[0], Vec3(1, 0, 0), 1.0f);
  expect_tangent(right[2], Vec3(1, 0, 0), 1.0f);
  EXPECT_EQ(right[0], left[0]);
  EXPECT_EQ(right[2], left[1]);
  expect_tangent(right[1], Vec3(1, 0, -1), 1.0f);  // the normals there are those of one triangle
  expect_tangent(left[2], Vec3(1, 0, 1), 1.0f);
}

// Two flat triangles at an edge, with angles of 90 and 45 degrees at a vertex, and directions of u that differ by 45
// degrees: the tangents are weighted by the angles.
TEST(TangentField, WeightedByAngle) {
  const auto mesh =
      make({0, 0, 0, 5, 0, 0, 0, 1, 0, -1, 1, 0}, {0, 1, 2, 0, 2, 3}, {0, 0, 5, 0, 0, 1, 0, 0, 0, 1, -1, 0});
  const auto field = geometry::make_tangents(mesh, *geometry::default_uv_map(*mesh));
  expect_tangent(field->corners(0)[0], 2.0f * Vec3(1, 0, 0) + glm::normalize(Vec3(1, -1, 0)), 1.0f);
}

// Two triangles with one edge in common whose other ends lie apart on the map, as at the pole of a sphere where each
// face has a map of its own.
TEST(TangentField, FacesThatMeetAtOnePointOfTheMapStaySeparate) {
  const auto mesh =
      make({0, 0, 0, 5, 0, 0, 0, 1, 0, -1, 1, 0}, {0, 1, 2, 0, 2, 3}, {0, 0, 5, 0, 0, 1, 0, 0, 1, 0, 1, 1});
  const auto field = geometry::make_tangents(mesh, *geometry::default_uv_map(*mesh));
  expect_tangent(field->corners(0)[0], Vec3(1, 0, 0), 1.0f);
  expect_tangent(field->corners(1)[0], Vec3(0, 1, 0), 1.0f);
}

// At the seam of a mirrored map, tangents have the direction of u or its opposite, but are never a mean of both.
TEST(TangentField, MirroredMapsStaySeparate) {
  const auto mesh =
      make({0, 0, 0, 0, 1, 0, 1, 0, 0, -1, 0, 0}, {0, 2, 1, 0, 1, 3}, {0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0});
  const auto field = geometry::make_tangents(mesh, *geometry::default_uv_map(*mesh));
  expect_tangent(field->corners(0)[0], Vec3(1, 0, 0), 1.0f);
  expect_tangent(field->corners(1)[0], Vec3(-1, 0, 0), -1.0f);
}

TEST(TangentField, TrianglesWithoutAreaOnTheMapUseTheirNeighbours) {
  const auto mesh =
      make({0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 0}, {0, 1, 2, 0, 2, 3}, {0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0.5f});
  const auto field = geometry::make_tangents(mesh, *geometry::default_uv_map(*mesh));
  expect_tangent(field->corners(1)[0], Vec3(1, 0, 0), 1.0f);
  EXPECT_EQ(field->corners(1)[2], Vec4(0.0f));
}

}  // namespace
}  // namespace gradus::tangent_field_test
