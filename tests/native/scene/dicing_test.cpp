// Dicing: division of meshes until their edges are short, against closed forms.
#include <gtest/gtest.h>

#include "geometry/diced_mesh.h"
#include "geometry/mesh.h"
#include "scene_fixture.h"

namespace gradus::test::dicing_test {
namespace {

// An octahedron with shared vertices and the normals of the unit sphere.
Soup octahedron() {
  Soup soup;
  soup.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  soup.vertices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  return soup;
}

Soup square() {
  Soup soup;
  soup.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  soup.vertices = {0, 1, 2, 0, 2, 3};
  return soup;
}

std::shared_ptr<const geometry::MeshData> smooth_octahedron() {
  MeshDesc desc(octahedron());
  desc.desc.normal_domain = GRADUS_DOMAIN_POINT;
  return geometry::make_mesh(desc.desc);
}

// Each division adds a vertex for every edge, so that neighbours share theirs: Euler's formula holds.
TEST(DicedMesh, HasNoCracks) {
  const auto mesh = geometry::diced_mesh(smooth_octahedron(), 3);
  EXPECT_EQ(mesh->triangle_count, 8u << 6);
  EXPECT_EQ(mesh->vertex_count, mesh->triangle_count / 2 + 2);
  EXPECT_EQ(mesh->normals.size(), mesh->vertex_count);
}

// Curved edges come near the sphere: straight ones would leave vertices at 1 / √3 of its radius.
TEST(DicedMesh, CurvesAlongNormals) {
  const auto mesh = geometry::diced_mesh(smooth_octahedron(), 4);
  for (uint32_t i = 0; i < mesh->vertex_count; ++i) {
    const Vec3& p = mesh->frame_positions()[i];
    EXPECT_GT(glm::length(p), 0.84f) << i;
    EXPECT_LT(glm::length(p), 1.001f) << i;
    EXPECT_GT(glm::dot(mesh->normals[i], glm::normalize(p)), 0.95f) << i;
  }
}

TEST(DicedMesh, KeepsPlanesAndAttributes) {
  MeshDesc desc(square());
  const std::array<float, 12> corners{-1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1};
  const std::array<float, 4> points{0, 2, 4, 2};
  std::array<GradusAttribute, 2> attributes{};
  attributes[0] = {sizeof(GradusAttribute), GRADUS_DOMAIN_CORNER, 2, 1, "uv", corners.data()};
  attributes[1] = {sizeof(GradusAttribute), GRADUS_DOMAIN_POINT, 1, 0, "sum", points.data()};
  desc.desc.attributes = attributes.data();
  desc.desc.attribute_count = 2;
  const auto mesh = geometry::diced_mesh(geometry::make_mesh(desc.desc), 2);
  ASSERT_EQ(mesh->triangle_count, 32u);
  for (uint32_t t = 0; t < mesh->triangle_count; ++t) {
    const auto p = geometry::triangle_positions(*mesh, t);
    const auto uv = geometry::corner_values(*mesh, mesh->attributes[0], t);
    const auto sum = geometry::corner_values(*mesh, mesh->attributes[1], t);
    EXPECT_GT(glm::cross(p[1] - p[0], p[2] - p[0]).z, 0.0f);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(p[k].z, 0.0f);
      EXPECT_EQ(Vec2(uv[k]), Vec2(p[k]));
      EXPECT_NEAR(sum[k].x, p[k].x + p[k].y + 2.0f, 1e-6f);
    }
  }
}

// Commits a square that is diced, 4 m below a camera that sees 2 m of it in width.
std::shared_ptr<const scene::Snapshot> commit(float rate, float length, uint32_t levels, float scale = 1.0f) {
  TestScene scene;
  MeshDesc desc(square());
  desc.desc.dicing_levels = levels;
  desc.desc.dicing_rate = rate;
  desc.desc.dicing_length = length;
  desc.desc.offscreen_dicing_scale = 4.0f;
  scene.scene.set_mesh(1, desc.desc);
  scene.instance(1, scaling(Vec3(scale)));
  GradusCamera camera{};
  camera.struct_size = sizeof(camera);
  camera.type = GRADUS_CAMERA_PERSPECTIVE;
  const std::array<float, 4> window{-0.25f, 0.25f, -0.25f, 0.25f};
  set_static(&camera, window.data(), translation(Vec3(0, 0, 4)));
  scene.scene.set_camera(camera);
  return scene.commit();
}

uint32_t triangles(const scene::Snapshot& snapshot) { return snapshot.instances[0].mesh->triangle_count; }

// The diagonal of the square is √2 pictures wide, so that five divisions make it shorter than a twentieth of one.
TEST(Dicing, ByThePicture) {
  EXPECT_EQ(triangles(*commit(0.05f, 0.0f, 12)), 2u << 10);
  EXPECT_EQ(triangles(*commit(2.0f, 0.0f, 12)), 2u);
  EXPECT_EQ(triangles(*commit(0.05f, 0.0f, 3)), 2u << 6);
  EXPECT_EQ(triangles(*commit(0.05f, 0.0f, 0)), 2u);
}

// Corners of a square that fills more than the picture are beyond its borders.
TEST(Dicing, IsCoarserBeyondTheBorders) { EXPECT_EQ(triangles(*commit(0.05f, 0.0f, 12, 1.2f)), 2u << 8); }

TEST(Dicing, ByLengthInTheSpaceOfTheMesh) { EXPECT_EQ(triangles(*commit(0.0f, 0.8f, 12, 7.0f)), 2u << 4); }

TEST(Dicing, HasALimitWithAWarning) {
  const auto snapshot = commit(1e-6f, 0.0f, 16);
  EXPECT_EQ(triangles(*snapshot), 2u << 20);
  ASSERT_EQ(snapshot->warnings.size(), 1u);
  EXPECT_NE(snapshot->warnings[0].find("coarser than its dicing rate"), std::string::npos);
}

}  // namespace
}  // namespace gradus::test::dicing_test
