#include "geometry/smooth_normals.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "geometry/mesh.h"
#include "gradus/gradus.h"
#include "support/path_scene.h"

namespace gradus::smooth_normals_test {
namespace {

// Describes a smooth mesh whose caller gives no normals. The arrays must outlive it.
template <class Positions, class Corners, class Triangles>
GradusMesh smooth_mesh(const Positions& positions, const Corners& corners, const Triangles& triangles) {
  GradusMesh desc{};
  desc.struct_size = sizeof(desc);
  desc.key_count = 1;
  desc.vertex_count = positions.size() / 3;
  desc.positions = positions.data();
  desc.corner_count = corners.size();
  desc.corner_vertices = corners.data();
  desc.triangle_count = triangles.size() / 3;
  desc.triangle_corners = triangles.data();
  desc.normal_domain = GRADUS_DOMAIN_POINT;
  return desc;
}

// An octahedron with shared vertices, stretched along z: by symmetry, every normal is the direction of its vertex.
TEST(SmoothNormals, SymmetricVertices) {
  const std::array<float, 18> positions{1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 2, 0, 0, -2};
  const std::array<int32_t, 24> corners{0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  std::array<uint32_t, 24> triangles{};
  for (uint32_t i = 0; i < triangles.size(); ++i) triangles[i] = i;
  const GradusMesh desc = smooth_mesh(positions, corners, triangles);
  const auto mesh = geometry::make_mesh(desc);
  ASSERT_EQ(mesh->normals.size(), 6u);
  for (uint32_t i = 0; i < 6; ++i) {
    const Vec3 p(positions[i * 3], positions[i * 3 + 1], positions[i * 3 + 2]);
    EXPECT_NEAR(glm::dot(mesh->normals[i], glm::normalize(p)), 1.0f, 1e-6f) << i;
  }
}

// Two faces meet at a vertex with angles of 90 and 45 degrees: the normal is their mean with those weights, whatever
// their areas.
TEST(SmoothNormals, WeightedByAngle) {
  const std::array<float, 12> positions{0, 0, 0, 5, 0, 0, 0, 1, 0, 0, 1, 1};
  const std::array<int32_t, 6> corners{0, 1, 2, 0, 2, 3};
  const std::array<uint32_t, 6> triangles{0, 1, 2, 3, 4, 5};
  const GradusMesh desc = smooth_mesh(positions, corners, triangles);
  const auto mesh = geometry::make_mesh(desc);
  const Vec3 expected = glm::normalize(2.0f * Vec3(0, 0, 1) + Vec3(1, 0, 0));
  EXPECT_NEAR(glm::dot(mesh->normals[0], expected), 1.0f, 1e-6f);
}

// Regression: the normals of quads and n-gons were those of their triangles, up to 22° off Blender's.
TEST(SmoothNormals, PolygonsHaveOneNormal) {
  // A pentagon that is not flat, followed by a triangle that shares an edge with it.
  const std::array<float, 18> positions{0, 0, 0, 2, 0, 0.5f, 2.5f, 1.5f, 0, 1, 2, 0.8f, -0.5f, 1, 0, 1, -1, 1};
  const std::array<int32_t, 8> corners{0, 1, 2, 3, 4, 1, 0, 5};
  const std::array<uint32_t, 12> triangles{4, 0, 1, 1, 2, 3, 3, 4, 1, 5, 6, 7};
  const std::array<int32_t, 4> faces{0, 0, 0, 1};
  GradusMesh desc = smooth_mesh(positions, corners, triangles);
  desc.triangle_faces = faces.data();
  desc.face_count = 2;
  const auto mesh = geometry::make_mesh(desc);
  const auto p = [&](int i) { return Vec3(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]); };
  Vec3 newell(0.0f);
  for (int i = 0; i < 5; ++i) newell += 0.5f * glm::cross(p(i), p((i + 1) % 5));
  const Vec3 pentagon = glm::normalize(newell), triangle = glm::normalize(glm::cross(p(0) - p(1), p(5) - p(1)));
  for (int i = 2; i < 5; ++i) EXPECT_NEAR(glm::dot(mesh->normals[i], pentagon), 1.0f, 1e-6f) << i;
  const auto angle = [&](int at, int a, int b) {
    return std::acos(glm::dot(glm::normalize(p(a) - p(at)), glm::normalize(p(b) - p(at))));
  };
  const Vec3 expected = glm::normalize(pentagon * angle(1, 0, 2) + triangle * angle(1, 0, 5));
  EXPECT_NEAR(glm::dot(mesh->normals[1], expected), 1.0f, 1e-6f);
}

// Regression: stretching rotates facets and normals differently. A normal that was then below its facet was negated, so
// that the facet was lit from the wrong side, and rays left glass instead of entering it.
TEST(SmoothNormals, NormalsBelowStretchedFacets) {
  test::PathScene scene;
  const Vec3 axis = glm::normalize(Vec3(1, 2, 3));  // of a coarse ball that is pressed flat
  for (int i = 0; i < 3; ++i) scene.place[i] -= Vec4(0.875f * axis[i] * axis, 0.0f);
  scene.ball(Vec3(0.0f), 1.0f, scene.material(test::matte(Rgb(0.5f))), 4, true);
  scene.camera(Vec3(0, 0, 4), Vec3(0.0f), 1.0f);
  const auto snapshot = scene.context(test::test_settings(4, 4)).snapshot;
  int below = 0;
  for (int i = 0; i < 1000; ++i) {
    const float z = 1.0f - (2.0f * float(i) + 1.0f) / 1000.0f, around = 2.399963f * float(i);
    const Vec3 out = Mat3(scene.place) *
                     Vec3(std::sqrt(1.0f - z * z) * std::cos(around), std::sqrt(1.0f - z * z) * std::sin(around), z);
    geometry::Hit hit;
    ASSERT_TRUE(snapshot->intersect(Ray{3.0f * out, 0.0f, -glm::normalize(out), kInfinity}, GRADUS_VISIBLE_ALL, &hit));
    const geometry::SurfacePoint point = snapshot->surface_point(hit);
    std::array<Vec3, 3> n;
    ASSERT_TRUE(geometry::triangle_normals(*snapshot->instances[0].mesh, hit.primitive, &n));
    const Vec3 smooth = glm::normalize(snapshot->instances[0].normal_to_world * geometry::interpolate(n, hit.uv));
    below += glm::dot(smooth, point.geometric_normal) < 0.0f;
    EXPECT_GE(glm::dot(point.shading_normal, point.geometric_normal), 0.0f);
    // The expected normal is mirrored at the facet: its tangential component stays.
    const Vec3 along = smooth - point.geometric_normal * glm::dot(smooth, point.geometric_normal);
    EXPECT_NEAR(glm::dot(point.shading_normal, along), glm::dot(along, along), 1e-5f);
  }
  EXPECT_GT(below, 0);
}

// The curvature of a ball is one over its radius, whatever its scale; that of a quad is 0.
TEST(SmoothNormals, Curvature) {
  test::PathScene scene;
  const uint64_t material = scene.material(test::matte(Rgb(0.5f)));
  scene.place = Mat4(2.0f);
  scene.place[3][3] = 1.0f;
  scene.ball(Vec3(0), 0.25f, material, 16, true);
  scene.quad(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0), material);
  const integrator::IntegratorContext context = scene.context(test::test_settings(4, 4));
  const scene::Snapshot& snapshot = *context.snapshot;
  for (uint32_t i = 0; i < 2; ++i) {
    geometry::Hit hit;
    hit.instance = i;
    hit.primitive = snapshot.instances[i].mesh->triangle_count / 2;
    EXPECT_NEAR(snapshot.curvature(hit), snapshot.instances[i].mesh->triangle_count == 2 ? 0.0f : 2.0f, 0.1f);
  }
}

}  // namespace
}  // namespace gradus::smooth_normals_test
