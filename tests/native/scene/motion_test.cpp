// Motion while the shutter is open: rays meet objects at the position of their time, and leave them without self-hits.
#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "geometry/matrix_keys.h"
#include "geometry/mesh.h"
#include "geometry/rays4.h"
#include "path/segment.h"
#include "scene_fixture.h"
#include "support/refusal.h"

namespace gradus::test::motion_test {
namespace {

Mat4 turn(float angle, const Vec3& axis) { return glm::rotate(Mat4(1.0f), angle, axis); }

// Returns a sphere that moves, rotates and grows, a sphere that deforms and moves, and a static one.
std::shared_ptr<const scene::Snapshot> moving_spheres() {
  TestScene scene;
  const Soup ball = sphere(Vec3(0.0f), 1.0f, 20, 40);
  scene.mesh(1, ball);
  MeshDesc deforming(ball);
  std::vector<Vec3> keys;
  for (const Vec3& stretch : {Vec3(1.0f), Vec3(1.5f, 0.8f, 1.0f), Vec3(1.0f, 1.0f, 2.0f)})
    for (const Vec3& p : ball.positions) keys.push_back(p * stretch);
  deforming.desc.shutter_key_count = 3;
  deforming.desc.shutter_positions = &keys[0].x;
  deforming.desc.normal_domain = GRADUS_DOMAIN_POINT;
  scene.scene.set_mesh(2, deforming.desc);
  scene.shutter_poses = {
      translation(Vec3(-0.5f, 0, 0)),
      translation(Vec3(1, 0.5f, 0)) * turn(2.0f, glm::normalize(Vec3(1, 1, 0))) * scaling(Vec3(1.3f))};
  scene.instance(1, translation(Vec3(-3, 0, 0)));
  scene.shutter_poses = {Mat4(1.0f), translation(Vec3(0, 0, 1)), translation(Vec3(0, 0, 1.5f))};
  scene.instance(2, scaling(Vec3(-1, 1, 1)));
  scene.shutter_poses.clear();
  scene.instance(1, translation(Vec3(3, 0, 0)));
  return scene.commit();
}

// Returns a ray towards one of the three.
Ray random_ray(std::mt19937& random) {
  std::uniform_real_distribution<float> u(0.0f, 1.0f);
  const Vec3 target = Vec3(-3.0f + 3.0f * float(random() % 3), 0, 0) + random_direction(random) * 0.7f;
  Ray ray;
  ray.origin = target + random_direction(random) * (2.5f + 5.0f * u(random));
  ray.direction = glm::normalize(target - ray.origin);
  ray.time = u(random);
  return ray;
}

TEST(Motion, HitsLieOnTheRayAtItsTime) {
  const auto snapshot = moving_spheres();
  std::mt19937 random(3);
  int met[3] = {};
  for (int i = 0; i < 30000; ++i) {
    const Ray ray = random_ray(random);
    geometry::Hit hit;
    if (!snapshot->intersect(ray, GRADUS_VISIBLE_CAMERA, &hit)) continue;
    ++met[hit.instance];
    ASSERT_EQ(hit.time, ray.time);
    const geometry::SurfacePoint point = snapshot->surface_point(hit);
    const Vec3 along = ray.origin + ray.direction * hit.t;
    ASSERT_LT(glm::length(point.position - along), 2e-4f) << hit.instance << ' ' << ray.time;
    const auto p = snapshot->corners(hit.instance, hit.primitive, ray.time);
    const Vec3 normal = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0]));
    ASSERT_GT(std::fabs(glm::dot(normal, point.geometric_normal)), 0.9999f);
    ASSERT_GT(glm::dot(point.shading_normal, point.geometric_normal), 0.9f);
  }
  for (const int count : met) EXPECT_GT(count, 3000);
}

TEST(Motion, RaysThatLeaveDoNotMeetTheirSurfaceAgain) {
  const auto snapshot = moving_spheres();
  std::mt19937 random(4);
  int tried = 0;
  for (int i = 0; i < 60000; ++i) {
    geometry::Hit hit;
    if (!snapshot->intersect(random_ray(random), GRADUS_VISIBLE_CAMERA, &hit)) continue;
    const geometry::SurfacePoint point = snapshot->surface_point(hit);
    Vec3 direction = random_direction(random);
    if (glm::dot(direction, point.geometric_normal) < 0.0f) direction = -direction;
    geometry::Hit again;
    ++tried;
    const bool met = snapshot->intersect(path::spawn_ray(point, direction), GRADUS_VISIBLE_CAMERA, &again);
    ASSERT_FALSE(met && again.instance == hit.instance && again.t < 1e-3f)
        << hit.instance << " at " << hit.time << ": " << again.t;
  }
  EXPECT_GT(tried, 20000);
}

TEST(Motion, RaysFromASurfaceAreAtItsTime) {
  const auto snapshot = moving_spheres();
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    geometry::Hit hit, other;
    if (!snapshot->intersect(random_ray(random), GRADUS_VISIBLE_CAMERA, &hit)) continue;
    if (!snapshot->intersect(random_ray(random), GRADUS_VISIBLE_CAMERA, &other)) continue;
    other.time = hit.time;
    const geometry::SurfacePoint from = snapshot->surface_point(hit), to = snapshot->surface_point(other);
    EXPECT_EQ(path::spawn_ray(from, random_direction(random)).time, hit.time);
    EXPECT_EQ(path::spawn_ray_to(from, to).time, hit.time);
  }
}

TEST(Motion, PacketsHaveTheTimesOfTheirRays) {
  const auto snapshot = moving_spheres();
  std::mt19937 random(5);
  for (int i = 0; i < 5000; ++i) {
    Ray rays[4];
    geometry::Hit four[4];
    for (Ray& ray : rays) ray = random_ray(random);
    snapshot->intersect4(rays, GRADUS_VISIBLE_CAMERA, four);
    for (int k = 0; k < 4; ++k) {
      geometry::Hit one;
      snapshot->intersect(rays[k], GRADUS_VISIBLE_CAMERA, &one);
      ASSERT_EQ(one.instance, four[k].instance);
      if (one.valid()) {
        ASSERT_EQ(one.time, four[k].time);
      }
    }
  }
}

// The smooth normals of a sphere that becomes an ellipsoid are those of the ellipsoid.
TEST(Motion, NormalsFollowADeformation) {
  TestScene scene;
  const Soup ball = sphere(Vec3(0.0f), 1.0f, 64, 128);
  MeshDesc mesh(ball);
  const Vec3 stretch(2.0f, 1.0f, 0.5f);
  std::vector<Vec3> keys = ball.positions, normals;
  for (const Vec3& p : ball.positions) keys.push_back(p * stretch), normals.push_back(glm::normalize(p));
  mesh.desc.shutter_key_count = 2;
  mesh.desc.shutter_positions = &keys[0].x;
  mesh.desc.normal_domain = GRADUS_DOMAIN_POINT;
  mesh.desc.normals = &normals[0].x;
  scene.scene.set_mesh(1, mesh.desc);
  scene.instance(1);
  const auto snapshot = scene.commit();
  std::mt19937 random(8);
  for (int i = 0; i < 2000; ++i) {
    Ray ray;
    ray.direction = random_direction(random);
    ray.origin = -5.0f * ray.direction;
    ray.time = 1.0f;
    geometry::Hit hit;
    ASSERT_TRUE(snapshot->intersect(ray, GRADUS_VISIBLE_CAMERA, &hit));
    const geometry::SurfacePoint point = snapshot->surface_point(hit);
    const Vec3 expected = glm::normalize(point.position / (stretch * stretch));
    EXPECT_GT(glm::dot(point.shading_normal, expected), 0.998f);
  }
}

TEST(Motion, RefusesMoreThanTheMaximumNumberOfShutterKeys) {
  TestScene scene;
  MeshDesc mesh(sphere(Vec3(0.0f), 1.0f, 4, 8));
  const std::vector<Vec3> positions(mesh.desc.vertex_count * (geometry::kMaxShutterKeys + 1), Vec3(1.0f));
  mesh.desc.shutter_positions = &positions[0].x;
  mesh.desc.shutter_key_count = geometry::kMaxShutterKeys + 1;
  const std::string too_many = ": 130 shutter keys, at most 129 are possible";
  EXPECT_EQ(refusal_of([&] { scene.scene.set_mesh(1, mesh.desc); }), "mesh 'mesh'" + too_many);
  mesh.desc.shutter_key_count = 0;
  scene.scene.set_mesh(1, mesh.desc);
  scene.shutter_poses.assign(geometry::kMaxShutterKeys + 1, Mat4(1.0f));
  scene.instance(1);
  EXPECT_EQ(refusal_of([&] { scene.commit(); }), "instance 0" + too_many);
}

TEST(Motion, InvalidKeysRemoveTheMotionOrTheTriangle) {
  TestScene scene;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Soup ball = sphere(Vec3(0.0f), 1.0f, 8, 16);
  scene.mesh(1, ball);
  scene.shutter_poses = {Mat4(1.0f), Mat4(nan)};
  scene.instance(1);
  scene.shutter_poses = {Mat4(1.0f), scaling(Vec3(0.0f))};
  scene.instance(1, translation(Vec3(5, 0, 0)));
  scene.shutter_poses.clear();
  MeshDesc torn(ball);
  std::vector<Vec3> keys = ball.positions;
  keys.insert(keys.end(), ball.positions.begin(), ball.positions.end());
  keys[20].x = nan;
  torn.desc.shutter_key_count = 2;
  torn.desc.shutter_positions = &keys[0].x;
  scene.scene.set_mesh(2, torn.desc);
  scene.instance(2, translation(Vec3(10, 0, 0)));
  const auto snapshot = scene.commit();
  ASSERT_EQ(snapshot->instances.size(), 3u);
  EXPECT_FALSE(snapshot->instances[0].moves());
  EXPECT_FALSE(snapshot->instances[1].moves());
  EXPECT_GT(snapshot->instances[2].mesh->dropped_triangles, 0u);
  ASSERT_EQ(snapshot->warnings.size(), 1u);
}

// If the shutter never opens, the time has no effect and no cost.
TEST(Motion, WithoutAShutterNothingMoves) { EXPECT_FALSE(moving_spheres()->features.has_motion); }

}  // namespace
}  // namespace gradus::test::motion_test
