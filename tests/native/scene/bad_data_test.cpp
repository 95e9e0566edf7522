// D3, D7, and broken instances and meshes: only the broken object is lost, not the frame.
#include <chrono>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/fpu.h"
#include "geometry/accelerator.h"
#include "geometry/mesh.h"
#include "geometry/plane.h"
#include "light/light_table.h"
#include "scene_fixture.h"

namespace gradus::test::bad_data_test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

float random_bits(std::mt19937& random) {
  const auto bits = uint32_t(random());
  float f;
  std::memcpy(&f, &bits, sizeof(f));
  return f;
}

bool is_finite_hit(const scene::Snapshot& snapshot, const geometry::Hit& hit) {
  const geometry::SurfacePoint p = snapshot.surface_point(hit);
  return is_finite(p.position) && is_finite(p.geometric_normal) && is_finite(p.shading_normal) && is_finite(p.error);
}

TEST(D3_Garbage, ThousandMeshesOfRandomBits) {
  const auto began = std::chrono::steady_clock::now();
  std::mt19937 random(21);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 1000; ++i) {
    Soup soup;
    const int triangles = 1 + int(random() % 100);
    for (int v = 0; v < triangles * 3; ++v) {
      const float x = random_bits(random), y = random_bits(random);
      soup.positions.push_back({x, y, random_bits(random)});
      soup.vertices.push_back(v);
    }
    // In half of the meshes, one index in 32 is random.
    for (int32_t& v : soup.vertices)
      if (i % 2 && random() % 32 == 0) v = int32_t(random());
    std::vector<float> normals(soup.positions.size() * 3);
    for (float& n : normals) n = random_bits(random);
    MeshDesc mesh(soup);
    mesh.desc.normal_domain = random() % 3;
    mesh.desc.normals = mesh.desc.normal_domain == GRADUS_DOMAIN_FACE ? nullptr : normals.data();
    TestScene scene;
    try {
      scene.scene.set_mesh(1, mesh.desc);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), GRADUS_ERROR_INVALID_ARGUMENT);
      EXPECT_NE(std::string(error.what()).find("'mesh'"), std::string::npos);
      ++refused;
      continue;
    }
    ++accepted;
    Mat4 matrix(1.0f);
    if (i % 3 == 0)
      for (int k = 0; k < 16; ++k) matrix[k / 4][k % 4] = random_bits(random);
    scene.instance(1, matrix);
    const auto snapshot = scene.commit();
    for (int k = 0; k < 50; ++k) {
      geometry::Hit hit;
      if (snapshot->intersect({Vec3(0.0f), 0.0f, random_direction(random), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit)) {
        EXPECT_TRUE(is_finite_hit(*snapshot, hit));
      }
    }
  }
  EXPECT_GE(accepted, 500);
  EXPECT_GE(refused, 300);
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(60));
}

// Render threads flush denormals.
TEST(D7_Degenerate, TrianglesWhoseSquaredEdgesAreFlushedHaveAnError) {
  const FlushDenormals flush;
  const geometry::Plane plane =
      geometry::plane_of({Vec3(6e-22f, 6e-26f, 0.0f), Vec3(0.0f, 2e-29f, 0.0f), Vec3(0.0f, 0.0f, 9e-15f)});
  EXPECT_TRUE(is_finite(plane.error));
  EXPECT_GT(plane.normal.y, 0.99f);
}

TEST(D7_Degenerate, OnlyValidTrianglesAreHit) {
  Soup soup;
  soup.triangle({-1, -1, 3}, {1, -1, 3}, {0, 1, 3});       // valid
  soup.triangle({0, 0, 1}, {0, 0, 1}, {0, 0, 1});          // a point
  soup.triangle({-1, 0, 1}, {0, 0, 1}, {1, 0, 1});         // a line
  soup.triangle({kNan, 0, 2}, {0, 1, 2}, {1, 0, 2});       // NaN
  soup.triangle({kInfinity, 0, 2}, {0, 1, 2}, {1, 0, 2});  // infinite
  soup.triangle({1e30f, 0, 2}, {-1e30f, 1e30f, 2}, {-1e30f, -1e30f, 2});
  soup.triangle({-1e7f, 0.1f, 2}, {1e7f, 0.1f, 2}, {0, 0.1000001f, 2});  // a sliver
  TestScene scene;
  scene.mesh(1, soup);
  scene.instance(1);
  const auto snapshot = scene.commit();
  EXPECT_EQ(snapshot->instances[0].mesh->dropped_triangles, 3u);
  geometry::Hit hit;
  ASSERT_TRUE(snapshot->intersect({Vec3(0.0f), 0.0f, Vec3(0, 0, 1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
  EXPECT_EQ(hit.primitive, 0u);
  std::mt19937 random(22);
  for (int i = 0; i < 100000; ++i) {
    if (snapshot->intersect({Vec3(0.0f), 0.0f, random_direction(random), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit)) {
      ASSERT_TRUE(is_finite_hit(*snapshot, hit));
    }
  }
}

TEST(D7_Degenerate, CoincidentTriangles) {
  Soup soup;
  for (int i = 0; i < 10000; ++i) soup.triangle({-1, -1, 3}, {1, -1, 3}, {0, 1, 3});
  TestScene scene;
  scene.mesh(1, soup);
  scene.instance(1);
  geometry::Hit hit;
  const auto snapshot = scene.commit();
  ASSERT_TRUE(snapshot->intersect({Vec3(0.0f), 0.0f, Vec3(0, 0, 1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
  EXPECT_TRUE(is_finite_hit(*snapshot, hit));
}

TEST(D7_Degenerate, MeshWithoutTriangles) {
  Soup loose;
  loose.positions = {{0, 0, 0}, {1, 0, 0}};
  TestScene scene;
  scene.mesh(1, loose);
  scene.mesh(2, Soup());
  scene.instance(1);
  scene.instance(2);
  EXPECT_TRUE(scene.commit()->instances.empty());
}

TEST(D8_Instances, HundredThousandAreAllThere) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 0.4f, 4, 8));
  for (int i = 0; i < 100000; ++i)
    scene.instance(1, translation(Vec3(float(i % 400), float(i / 400), 0)) * scaling(Vec3(i % 2 ? 1.0f : -1.0f, 1, 1)));
  const auto snapshot = scene.commit();
  ASSERT_EQ(snapshot->instances.size(), 100000u);
  for (uint32_t i = 0; i < 100000; i += 37) {
    geometry::Hit hit;
    ASSERT_TRUE(snapshot->intersect({Vec3(float(i % 400), float(i / 400), 3), 0.0f, Vec3(0, 0, -1), kInfinity},
                                    GRADUS_VISIBLE_CAMERA, &hit));
    EXPECT_EQ(hit.instance, i);
    EXPECT_GT(snapshot->surface_point(hit).geometric_normal.z, 0.5f);
  }
}

TEST(BadMatrix, OneWarningNamesTheFirstAndCounts) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 4, 8));
  scene.instance(1);
  Mat4 nan(1.0f);
  nan[1][2] = kNan;
  scene.instance(1, nan);
  scene.instance(1, scaling(Vec3(0.0f)));
  scene.instance(1, scaling(Vec3(1, 0, 1)));
  scene.instance(1, scaling(Vec3(1, -2, 1)));
  scene.instance(7);
  const auto snapshot = scene.commit();
  EXPECT_EQ(snapshot->instances.size(), 2u);
  ASSERT_EQ(snapshot->warnings.size(), 2u);
  EXPECT_EQ(snapshot->warnings[0],
            "3 objects were left out, the first is 'number 1': its matrix is singular or not finite");
}

// Regression: triangles without finite positions, and whole objects of them, disappeared without a warning.
TEST(BadMesh, TrianglesThatAreNotFiniteAreReportedOnce) {
  Soup torn;
  torn.triangle({-1, -1, 3}, {1, -1, 3}, {0, 1, 3});
  torn.triangle({kNan, 0, 2}, {0, 1, 2}, {1, 0, 2});
  Soup lost;
  lost.triangle({kNan, 0, 2}, {0, 1, 2}, {1, 0, 2});
  TestScene scene;
  scene.mesh(1, torn);
  scene.mesh(2, lost);
  for (const uint64_t mesh : {1, 1, 2}) scene.instance(mesh);
  const auto snapshot = scene.commit();
  EXPECT_EQ(snapshot->instances.size(), 2u);
  ASSERT_EQ(snapshot->warnings.size(), 2u);
  EXPECT_EQ(snapshot->warnings[0], "object 'number 2' was left out: no triangle has finite vertices");
  EXPECT_EQ(snapshot->warnings[1], "2 objects lost triangles, the first is 'number 0': some vertices are not finite");
}

// Regression: a sun whose radiance exceeds all numbers was left out without a warning, although its strength is finite.
TEST(BadLight, ASunOfInfiniteRadianceIsNamed) {
  TestScene scene;
  GradusLight sun = make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(3e38f));
  sun.angle = 0.01f;
  scene.lights({sun});
  const auto snapshot = scene.commit();
  ASSERT_EQ(snapshot->warnings.size(), 1u);
  EXPECT_NE(snapshot->warnings[0].find("their values are not finite"), std::string::npos);
}

// Regression: emissive triangles beyond the maximum of light sampling are found by chance only, and there was no
// warning.
TEST(ManyLights, AnObjectWithTooManyTrianglesIsReported) {
  Soup soup;
  soup.triangle({-1, -1, 3}, {1, -1, 3}, {0, 1, 3});
  soup.positions.push_back({kNan, 0, 0});
  soup.vertices.resize(3 * ((size_t(4) << 20) + 1), 3);  // dropped, but counted: quick to build
  TestScene scene;
  scene.material(1, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f)));
  scene.mesh(1, soup);
  scene.mesh(2, sphere(Vec3(0.0f), 1.0f, 4, 8));
  scene.instance(2, Mat4(1.0f), GRADUS_VISIBLE_ALL, 1);
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 1);
  const auto snapshot = scene.commit();
  EXPECT_EQ(snapshot->warnings.size(), 1u) << "of the vertices";
  ASSERT_EQ(snapshot->noise_warnings.size(), 1u);
  EXPECT_EQ(snapshot->noise_warnings[0], "object 'number 1' is not sampled as a light: too many triangles emit light");
  EXPECT_EQ(snapshot->light_table->beyond_limit, std::vector<uint32_t>{1});
}

TEST(BadMesh, ContradictingArraysAreRefusedByName) {
  const auto refusal = [](auto&& change) -> std::string {
    MeshDesc mesh(sphere(Vec3(0.0f), 1.0f, 4, 8));
    change(mesh.desc);
    try {
      geometry::make_mesh(mesh.desc);
    } catch (const Error& error) {
      return error.code() == GRADUS_ERROR_INVALID_ARGUMENT ? error.what() : "";
    }
    return "";
  };
  const int32_t negative[3] = {-1, -1, -1};
  const float descending[2] = {1.0f, 0.0f};
  EXPECT_NE(refusal([](GradusMesh& m) { m.positions = nullptr; }), "");
  EXPECT_NE(refusal([](GradusMesh& m) { m.vertex_count = 3; }), "");
  EXPECT_NE(refusal([](GradusMesh& m) { m.corner_count = 3; }), "");
  EXPECT_NE(refusal([](GradusMesh& m) { m.key_count = 0; }), "");
  EXPECT_NE(refusal([](GradusMesh& m) { m.triangle_count = size_t(1) << 60; }), "");
  EXPECT_NE(refusal([](GradusMesh& m) { m.normal_domain = 9; }), "");
  EXPECT_NE(refusal([&](GradusMesh& m) { m.corner_vertices = negative, m.corner_count = 3, m.triangle_count = 1; }),
            "");
  EXPECT_NE(refusal([&](GradusMesh& m) { m.key_count = 2, m.vertex_count /= 2, m.key_times = descending; }), "");
  EXPECT_EQ(refusal([](GradusMesh&) {}), "");
}

TEST(Commit, UnchangedGeometryIsShared) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 100, 200));
  scene.mesh(2, sphere(Vec3(0.0f), 1.0f, 4, 8));
  for (int i = 0; i < 3; ++i) scene.instance(1, translation(Vec3(float(3 * i), 0, 0)));
  scene.instance(2);
  const auto first = scene.commit();
  const auto second = scene.commit();
  EXPECT_EQ(first->accelerator, second->accelerator);
  EXPECT_EQ(first->content_key, second->content_key);
  // Setting the same content again is no change; a moved instance keeps its mesh's acceleration structure.
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 100, 200));
  EXPECT_EQ(scene.commit()->accelerator, first->accelerator);
  scene.instance(2, translation(Vec3(0, 5, 0)));
  const auto third = scene.commit();
  EXPECT_NE(third->accelerator, first->accelerator);
  EXPECT_NE(third->content_key, first->content_key);
  EXPECT_EQ(third->accelerator->static_part.group->mesh_scenes, first->accelerator->static_part.group->mesh_scenes);
  geometry::Hit hit;
  EXPECT_TRUE(second->intersect({Vec3(0, 0, 5), 0.0f, Vec3(0, 0, -1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
}

// Regression: each commit built the acceleration structure of the shadow catchers anew.
TEST(Commit, UnchangedShadowCatchersAreShared) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 20, 40));
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL | GRADUS_SHADOW_CATCHER);
  const auto first = scene.commit();
  scene.instance(1, translation(Vec3(0, 5, 0)));
  const auto second = scene.commit();
  ASSERT_TRUE(first->catchers && second->catchers);
  EXPECT_NE(second->accelerator, first->accelerator);
  EXPECT_EQ(second->catchers->accelerator, first->catchers->accelerator);
  scene.instance(1, translation(Vec3(0, 9, 0)), GRADUS_VISIBLE_ALL | GRADUS_SHADOW_CATCHER);
  EXPECT_NE(scene.commit()->catchers->accelerator, first->catchers->accelerator);
}

TEST(Cancel, StopsABuildAndKeepsTheLastSnapshot) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 4, 8));
  scene.instance(1);
  const auto before = scene.commit();
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 700, 700));
  const volatile int32_t cancel = 1;
  float progress = -1.0f;
  try {
    scene.scene.commit(&cancel, &progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), GRADUS_ERROR_CANCELLED);
  }
  EXPECT_EQ(scene.scene.snapshot(), before);
  progress = -1.0f;
  scene.scene.commit(nullptr, &progress);
  EXPECT_EQ(progress, 1.0f);
}

}  // namespace
}  // namespace gradus::test::bad_data_test
