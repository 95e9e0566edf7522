// D1, D2 and D4: watertightness, self-hits and broken rays; the values of a hit.
#include <limits>

#include <gtest/gtest.h>

#include "base/clock.h"
#include "camera/camera.h"
#include "geometry/rays4.h"
#include "light/light_sampling.h"
#include "scene/scene_fixture.h"

namespace gradus::test::geometry_test {
namespace {

TEST(D1_Watertight, SphereFarFromTheOriginSeenFromInside) {
  const Vec3 centre(148376.0f, 1234.0f, -223423.0f);
  TestScene scene;
  scene.mesh(1, sphere(centre, 2.0f, 200, 400));
  scene.instance(1);
  const auto snapshot = scene.commit();
  std::mt19937 random(1);
  int misses = 0;
  for (int i = 0; i < 1000000; ++i) {
    geometry::Hit hit;
    misses +=
        !snapshot->intersect({centre - snapshot->origin, 0.0f, random_direction(random)}, GRADUS_VISIBLE_CAMERA, &hit);
  }
  EXPECT_LE(misses, 20);
}

float random_coordinate(std::mt19937& random) {
  std::uniform_real_distribution<float> exponent(-8.0f, 8.0f);
  return std::pow(10.0f, exponent(random)) * (random() & 1 ? 1.0f : -1.0f);
}

Vec3 random_point(std::mt19937& random) {
  const float x = random_coordinate(random), y = random_coordinate(random);
  return {x, y, random_coordinate(random)};
}

// Spawns rays from points of a triangle, which must not meet it again. Returns the number of rays that do.
int count_self_hits(const scene::Snapshot& snapshot, uint32_t instance, uint32_t triangle, int rays,
                    std::mt19937& random) {
  std::uniform_real_distribution<float> uniform;
  int again = 0;
  for (int i = 0; i < rays; ++i) {
    geometry::Hit hit;
    hit.instance = instance;
    hit.primitive = triangle;
    const float root = std::sqrt(uniform(random));
    hit.uv = Vec2(1.0f - root, uniform(random) * root);
    const geometry::SurfacePoint point = snapshot.surface_point(hit);
    const Vec3 direction = random_direction(random);
    geometry::Hit next;
    again +=
        snapshot.intersect({geometry::offset_origin(point, direction), 0.0f, direction}, GRADUS_VISIBLE_CAMERA, &next);
  }
  return again;
}

bool is_degenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  const glm::dvec3 n = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
  return glm::dot(n, n) < 1e-20;
}

TEST(D2_SelfHits, TrianglesOfAllMagnitudes) {
  std::mt19937 random(2);
  int again = 0;
  for (int i = 0; i < 1000; ++i) {
    Vec3 p[3];
    do
      for (Vec3& v : p) v = random_point(random);
    while (is_degenerate(p[0], p[1], p[2]));
    Soup soup;
    soup.triangle(p[0], p[1], p[2]);
    TestScene scene;
    scene.mesh(1, soup);
    scene.instance(1);
    const int count = count_self_hits(*scene.commit(), 0, 0, 1000, random);
    EXPECT_EQ(count, 0) << "triangle " << i;
    again += count;
  }
  EXPECT_EQ(again, 0);
}

TEST(D2_SelfHits, InstancesFarAwayAndScaled) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  Soup big = sphere(Vec3(0.0f), 1.0f, 100, 200);  // too large to be copied into the top level
  TestScene scene;
  scene.mesh(1, big);
  for (int i = 0; i < 20; ++i) {
    const float size = std::pow(10.0f, 3.0f * uniform(random));
    scene.instance(1,
                   translation(1e5f * Vec3(uniform(random), uniform(random), uniform(random))) * scaling(Vec3(size)));
  }
  const auto snapshot = scene.commit();
  ASSERT_FALSE(snapshot->instances[0].is_in_top_level);
  int again = 0;
  for (uint32_t i = 0; i < 20; ++i)
    for (int k = 0; k < 500; ++k) {
      // Rays leave a convex body outwards: they could only meet the body itself.
      geometry::Hit hit;
      hit.instance = i;
      hit.primitive = random() % uint32_t(big.vertices.size() / 3);
      hit.uv = Vec2(0.3f, 0.3f);
      const geometry::SurfacePoint point = snapshot->surface_point(hit);
      Vec3 direction = random_direction(random);
      if (glm::dot(direction, point.geometric_normal) < 0.0f) direction = -direction;
      geometry::Hit next;
      if (snapshot->intersect({geometry::offset_origin(point, direction), 0.0f, direction}, GRADUS_VISIBLE_CAMERA,
                              &next))
        again += next.instance == i;
    }
  EXPECT_EQ(again, 0);
}

// A shadow ray ends before the emitter that it is traced to, whatever the size of both.
TEST(D2_SelfHits, ALightOnTheFarSideIsNotOccluded) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> exponent(-8.0f, 8.0f), uniform;
  int blocked = 0, requested = 0;
  for (int i = 0; i < 1000; ++i) {
    const float size = std::pow(10.0f, exponent(random));
    Soup floor, light;
    floor.triangle(size * Vec3(-1, -1, 0), size * Vec3(1, -1, 0), size * Vec3(0, 1, 0.1f));
    light.triangle(size * Vec3(-1, -1, 1), size * Vec3(0, 1, 1.1f), size * Vec3(1, -1, 1));
    TestScene scene;
    scene.material(5, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f)));
    scene.mesh(1, floor);
    scene.mesh(2, light);
    scene.instance(1);
    scene.instance(2, Mat4(1.0f), GRADUS_VISIBLE_ALL, 5);
    const auto snapshot = scene.commit();
    for (int k = 0; k < 100; ++k) {
      geometry::Hit hit;
      hit.instance = hit.primitive = 0;
      const float root = std::sqrt(uniform(random));
      hit.uv = Vec2(1.0f - root, uniform(random) * root);
      const geometry::SurfacePoint point = snapshot->surface_point(hit);
      light::LightPoint light_point;
      light::LightEvaluation view;
      const float choice = uniform(random), u = uniform(random);
      light::sample_light_point(*snapshot, {point.position, point.geometric_normal, false}, choice,
                                Vec2(u, uniform(random)), &light_point, &view);
      if (light_point.kind == light::LightKind::None || !(view.pdf > 0.0f)) continue;
      ++requested;
      blocked += snapshot->occluded(
          light::ray_to_light(geometry::offset_origin(point, view.direction), point, light_point, view));
    }
  }
  EXPECT_GT(requested, 50000);
  EXPECT_EQ(blocked, 0);
}

// Returns random rays from within a ball. In every ray of number `broken` another field is invalid; 0: all are valid.
std::vector<Ray> make_rays(int count, int broken) {
  std::mt19937 random(4);
  const float bad[3] = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity};
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Ray& ray = rays.emplace_back(Ray{Vec3(0.0f), 0.0f, random_direction(random), kInfinity});
    const int field = i % 8;
    const float value = bad[random() % 3], begin = bad[random() % 2], end = bad[2 * (random() % 2)];
    if (broken == 0 || i % broken != 0) continue;
    if (field < 3) ray.origin[field] = value;
    if (field >= 3 && field < 6) ray.direction[field - 3] = value;
    if (field == 6) ray.t_min = begin;
    if (field == 7) ray.t_max = end;
  }
  return rays;
}

// Returns the minimum CPU time in seconds over several rounds of tracing them; hits: those of one round.
double time_of(const scene::Snapshot& snapshot, const std::vector<Ray>& rays, int* hits) {
  double minimum = kInfinity;
  for (int round = 0; round < 5; ++round) {
    *hits = 0;
    const uint64_t began = thread_cpu_nanoseconds();
    for (const Ray& ray : rays) {
      geometry::Hit hit;
      *hits += snapshot.intersect(ray, GRADUS_VISIBLE_CAMERA, &hit) || snapshot.occluded(ray);
    }
    minimum = std::min(minimum, 1e-9 * double(thread_cpu_nanoseconds() - began));
  }
  return minimum;
}

TEST(D4_BrokenRays, AreMissesAndCheap) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 50, 100));
  scene.instance(1);
  const auto snapshot = scene.commit();
  constexpr int count = 100000;
  int hits = 0, broken_hits = 0;
  const double good = time_of(*snapshot, make_rays(count, 0), &hits),
               broken = time_of(*snapshot, make_rays(count, 1), &broken_hits);
  EXPECT_EQ(hits, count);
  EXPECT_EQ(broken_hits, 0);
  EXPECT_LT(broken, 2.5 * good);
}

// Rays of cameras whose parameters are not finite.
TEST(D4_BrokenRays, OfBrokenCamerasAreMissesOrFinite) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 50, 100));
  scene.instance(1);
  const auto snapshot = scene.commit();
  std::mt19937 random(6);
  const float bad[4] = {std::numeric_limits<float>::quiet_NaN(), kInfinity, -kInfinity, 0.0f};
  for (int i = 0; i < 100000; ++i) {
    GradusCamera desc{};
    desc.type = random() % 3;
    desc.panorama = random() % 7;
    desc.fisheye_fov = 3.0f;
    desc.fisheye_polynomial[1] = -1.0f;
    for (int k = 0; k < 16; ++k) desc.matrix[k] = k % 5 == 0 ? 1.0f : 0.0f;
    desc.window[0] = desc.window[2] = -0.5f;
    desc.window[1] = desc.window[3] = 0.5f;
    desc.clip_start = 0.1f;
    desc.clip_end = 100.0f;
    desc.aperture_radius = i % 3 == 0 ? 0.1f : 0.0f;
    desc.focus_distance = desc.aperture_ratio = 1.0f;
    float* const fields[] = {
        desc.matrix + random() % 16, desc.window + random() % 4, &desc.clip_start,     &desc.clip_end,
        &desc.aperture_radius,       &desc.focus_distance,       &desc.blade_rotation, &desc.aperture_ratio};
    *fields[i % 8] = bad[random() % 4];
    if (i % 5 == 0) desc.fisheye_polynomial[random() % 5] = bad[random() % 4];
    if (i % 7 == 0) desc.fisheye_fov = bad[random() % 4];
    desc.blades = i % 7;
    const Ray ray = camera::Camera(desc, 64, 48).ray({Vec2(20.5f, 30.5f), Vec2(0.3f, 0.6f)});
    geometry::Hit hit;
    if (!snapshot->intersect(ray, GRADUS_VISIBLE_CAMERA, &hit)) continue;
    const geometry::SurfacePoint point = snapshot->surface_point(hit);
    EXPECT_TRUE(is_finite(point.position) && is_finite(hit.t)) << i;
  }
}

TEST(Trace, PacketsOfFourEqualSingleRays) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 50, 100));
  scene.instance(1, translation(Vec3(0, 0, 2)));
  scene.instance(1, translation(Vec3(0, 1, -2)) * scaling(Vec3(1, 2, -1)));
  const auto snapshot = scene.commit();
  std::mt19937 random(5);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    Ray rays[4];
    geometry::Hit four[4];
    bool blocked[4];
    for (int k = 0; k < 4; ++k)
      rays[k] = {Vec3(0.0f), 0.0f, random_direction(random), k == 3 && i % 3 == 0 ? -1.0f : kInfinity};
    snapshot->intersect4(rays, GRADUS_VISIBLE_CAMERA, four);
    const Vec3 d[4] = {rays[0].direction, rays[1].direction, rays[2].direction, rays[3].direction};
    const bool wanted[4] = {true, true, true, rays[3].t_max > 0.0f};
    snapshot->occluded4(
        {geometry::same(Vec3(0.0f)), geometry::lanes(d[0], d[1], d[2], d[3]), geometry::same(kInfinity)}, wanted,
        blocked);
    for (int k = 0; k < 4; ++k) {
      geometry::Hit one;
      const bool hit = snapshot->intersect(rays[k], GRADUS_VISIBLE_CAMERA, &one);
      hits += hit;
      EXPECT_EQ(hit, four[k].valid());
      EXPECT_EQ(hit, blocked[k]);
      if (!hit || one.primitive != four[k].primitive) continue;
      EXPECT_NEAR(one.uv.x, four[k].uv.x, 2e-5f);
      EXPECT_NEAR(one.t, four[k].t, 1e-5f);
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(Trace, MasksHideInstancesFromKindsOfRays) {
  Soup soup;
  soup.triangle({-1, -1, 1}, {1, -1, 1}, {0, 1, 1});
  TestScene scene;
  scene.mesh(1, soup);
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_CAMERA);
  const auto snapshot = scene.commit();
  const Ray ray{Vec3(0.0f), 0.0f, Vec3(0, 0, 1), kInfinity};
  geometry::Hit hit;
  EXPECT_TRUE(snapshot->intersect(ray, GRADUS_VISIBLE_CAMERA, &hit));
  EXPECT_FALSE(snapshot->intersect(ray, GRADUS_VISIBLE_GLOSSY, &hit));
  EXPECT_FALSE(snapshot->occluded(ray));
}

TEST(SurfacePoint, NormalsOfMirroredInstancesPointOutside) {
  TestScene scene;
  scene.mesh(1, sphere(Vec3(0.0f), 1.0f, 20, 40));
  scene.instance(1, translation(Vec3(3, 0, 0)) * scaling(Vec3(-1, 1, 1)));
  const auto snapshot = scene.commit();
  geometry::Hit hit;
  ASSERT_TRUE(snapshot->intersect({Vec3(0.0f), 0.0f, Vec3(1, 0, 0.01f), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
  const geometry::SurfacePoint point = snapshot->surface_point(hit);
  EXPECT_LT(point.geometric_normal.x, -0.9f);
  EXPECT_LT(point.shading_normal.x, -0.9f);
  EXPECT_NEAR(point.position.x, 2.0f, 0.02f);
}

// Converts steps along a primitive to its parameters and back to positions.
TEST(SurfaceDerivatives, ParametersFollowSteps) {
  Soup soup;
  soup.triangle({-1, -1, 0.5f}, {2, -1, 0}, {0.5f, 3, 1});
  TestScene scene;
  scene.mesh(1, soup);
  scene.instance(1, Mat4(1.0f));
  const auto snapshot = scene.commit();
  geometry::Hit hit;
  hit.instance = hit.primitive = 0;
  hit.uv = Vec2(0.3f, 0.2f);
  const geometry::SurfaceDerivatives derivatives = snapshot->derivatives(hit);
  const Vec3 from = snapshot->position(hit), step = 0.1f * derivatives.dpdu - 0.05f * derivatives.dpdv;
  EXPECT_LT(glm::distance(from, snapshot->surface_point(hit).position), 1e-6f);
  hit.uv += derivatives.duv(step);
  EXPECT_NEAR(hit.uv.x, 0.4f, 1e-6f);
  EXPECT_NEAR(hit.uv.y, 0.15f, 1e-6f);
  EXPECT_LT(glm::distance(snapshot->position(hit), from + step), 1e-6f);
  EXPECT_EQ((geometry::SurfaceDerivatives{Vec3(1, 0, 0), Vec3(2, 0, 0)}.duv(step)), Vec2(0.0f));
}

TEST(Origin, FarScenesAreMovedAndNearOnesAreNot) {
  Soup soup;
  soup.triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  TestScene near, far;
  near.mesh(1, soup);
  near.instance(1, translation(Vec3(5, 0, 0)));
  EXPECT_EQ(near.commit()->origin, Vec3(0.0f));
  far.mesh(1, soup);
  far.instance(1, translation(Vec3(1e7f, 0, 0)));
  const auto snapshot = far.commit();
  EXPECT_NEAR(snapshot->origin.x, 1e7f, 2.0f);
  geometry::Hit hit;
  EXPECT_TRUE(snapshot->intersect({Vec3(1e7f, 0, 5) - snapshot->origin, 0.0f, Vec3(0, 0, -1), kInfinity},
                                  GRADUS_VISIBLE_CAMERA, &hit));
}

TEST(Commit, EmptySceneIsEmpty) {
  TestScene scene;
  const auto snapshot = scene.commit();
  geometry::Hit hit;
  EXPECT_FALSE(snapshot->intersect({Vec3(0.0f), 0.0f, Vec3(0, 0, 1), kInfinity}, GRADUS_VISIBLE_CAMERA, &hit));
}

}  // namespace
}  // namespace gradus::test::geometry_test
