// A scene that is moved to its vector keys equals the scene that is built there.
#include "scene/moved_snapshot.h"

#include <random>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "geometry/accelerator.h"
#include "geometry/mesh.h"
#include "scene/scene_fixture.h"

namespace gradus::test::moved_snapshot_test {
namespace {

// Three balls, the first of them static.
class MovedSnapshot : public ::testing::Test {
 protected:
  MovedSnapshot() {
    for (uint64_t i = 0; i < 3; ++i) {
      scene_.mesh(i, sphere(Vec3(2.0f * float(i), 0, 0), 0.8f, 12, 24));
      scene_.instance(i);
    }
    scene_.matrices_before = {Mat4(1.0f), translation(Vec3(0, 0.3f, 0)), scaling(Vec3(-1, 1, 1))};
    scene_.matrices_after = {Mat4(1.0f), glm::rotate(Mat4(1.0f), 0.3f, Vec3(0, 0, 1)), translation(Vec3(0, 0, 0.4f))};
  }
  static void expect_equal(const scene::Snapshot& a, const scene::Snapshot& b) {
    std::mt19937 random(1);
    size_t hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 at = Vec3(2, 0, 0) + 6.0f * random_direction(random);
      const Ray ray{at, 0.0f, glm::normalize(Vec3(4.0f * float(i % 100) / 100.0f, 0, 0) - at)};
      geometry::Hit x, y;
      ASSERT_EQ(a.intersect(ray, GRADUS_VISIBLE_CAMERA, &x), b.intersect(ray, GRADUS_VISIBLE_CAMERA, &y));
      if (!x.valid()) continue;
      ++hits;
      EXPECT_EQ(x.instance, y.instance);
      EXPECT_NEAR(x.t, y.t, 1e-5f * x.t);
      EXPECT_GT(glm::dot(a.surface_point(x).shading_normal, b.surface_point(y).shading_normal), 0.99999f);
    }
    EXPECT_GT(hits, 1000u);
  }

  TestScene scene_;
};

TEST_F(MovedSnapshot, ObjectsAreWhereTheirMatricesPlaceThem) {
  const auto now = scene_.commit();
  const std::array<std::vector<Mat4>, 2> matrices{scene_.matrices_before, scene_.matrices_after};
  const std::array<Moment, 2> moments{Moment::Previous, Moment::Next};
  scene_.matrices_before.clear();
  scene_.matrices_after.clear();
  for (const size_t k : {0, 1}) {
    for (size_t i = 0; i < 3; ++i) scene_.move(i, matrices[k][i]);
    expect_equal(*scene::moved_snapshot(*now, moments[k]), *scene_.commit());
  }
}

// Surface points of one scene are found in the other at the ends of their vectors.
TEST_F(MovedSnapshot, SurfacePointsAreAtTheEndsOfTheirVectors) {
  const auto now = scene_.commit();
  const auto next = scene::moved_snapshot(*now, Moment::Next);
  for (uint32_t instance = 0; instance < 3; ++instance) {
    geometry::Hit hit;
    hit.instance = instance, hit.primitive = 40, hit.uv = Vec2(0.3f, 0.2f);
    EXPECT_LT(glm::length(now->position_at(hit, Moment::Next) - next->surface_point(hit).position), 1e-5f);
  }
}

// Objects that are translated move straight: at half the time they are in the middle.
TEST_F(MovedSnapshot, MovesByAFraction) {
  scene_.matrices_before.clear();
  scene_.matrices_after = {translation(Vec3(1, 0, 0)), translation(Vec3(0, 2, 0)), translation(Vec3(0, 0, 4))};
  for (size_t i = 0; i < 3; ++i) scene_.move(i, Mat4(1.0f));
  const auto now = scene_.commit();
  const auto half = scene::moved_snapshot(
      *now, Moment::Next, [] { return false; }, 0.5f);
  for (uint32_t instance = 0; instance < 3; ++instance) {
    geometry::Hit hit;
    hit.instance = instance, hit.primitive = 40, hit.uv = Vec2(0.3f, 0.2f);
    const Vec3 middle = 0.5f * (now->position_at(hit, Moment::Now) + now->position_at(hit, Moment::Next));
    EXPECT_LT(glm::length(middle - half->surface_point(hit).position), 1e-5f);
    EXPECT_GT(glm::length(middle - now->position_at(hit, Moment::Now)), 0.4f);
  }
}

TEST_F(MovedSnapshot, StaticObjectsAreShared) {
  scene_.matrices_before.clear();
  scene_.matrices_after.clear();
  const auto now = scene_.commit();
  EXPECT_EQ(scene::moved_snapshot(*now, Moment::Next)->accelerator, now->accelerator);
}

TEST_F(MovedSnapshot, MeshesHaveTheShapeOfTheirKeys) {
  const Soup small = sphere(Vec3(0, 0, 0), 0.8f, 12, 24), large = sphere(Vec3(0, 0, 0), 1.2f, 12, 24);
  std::vector<Vec3> keys = small.positions;
  keys.insert(keys.end(), large.positions.begin(), large.positions.end());
  const std::array<float, 2> times{0.0f, 1.0f};
  MeshDesc mesh(small);
  mesh.desc.key_count = 2;
  mesh.desc.key_times = times.data();
  mesh.desc.positions = &keys[0].x;
  mesh.desc.normal_domain = GRADUS_DOMAIN_POINT;
  scene_.scene.set_mesh(0, mesh.desc);
  const auto now = scene_.commit();
  const auto next = scene::moved_snapshot(*now, Moment::Next), previous = scene::moved_snapshot(*now, Moment::Previous);
  MeshDesc grown(large);
  grown.desc.normal_domain = GRADUS_DOMAIN_POINT;
  scene_.scene.set_mesh(0, grown.desc);
  for (size_t i = 0; i < 3; ++i) scene_.move(i, scene_.matrices_after[i]);
  expect_equal(*next, *scene_.commit());
  const Ray ray{Vec3(0, 0, 5), 0.0f, Vec3(0, 0, -1)};
  geometry::Hit hit;
  ASSERT_TRUE(previous->intersect(ray, GRADUS_VISIBLE_CAMERA, &hit));
  EXPECT_NEAR(hit.t, 4.2f, 0.02f) << "before its first key a mesh keeps its shape";
}

TEST_F(MovedSnapshot, CanBeCancelled) {
  const auto now = scene_.commit();
  EXPECT_ANY_THROW(scene::moved_snapshot(*now, Moment::Next, [] { return true; }));
}

}  // namespace
}  // namespace gradus::test::moved_snapshot_test
