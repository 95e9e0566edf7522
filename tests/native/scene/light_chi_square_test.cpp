// A3: directions of light sampling against its density, which is asked for by rays (everything that a ray in that direction would meet).
#include <gtest/gtest.h>

#include "scene/emitters.h"
#include "scene_fixture.h"
#include "support/chi_square.h"

namespace gradus::test {
namespace {

using gradus::testing::chi_square_sphere;
using gradus::testing::ChiSquareOptions;
using gradus::testing::ChiSquareResult;

double density(const Snapshot& snapshot, const Receiver& receiver, const Vec3& direction) {
  double sum = 0.0;
  const Ray ray{receiver.position, 0.0f, direction, kInfinity};
  std::vector<LampHit> hits;
  intersect_lamps(snapshot, ray, &hits);
  for (const LampHit& met : hits) sum += emitter_pdf(snapshot, met.point, receiver);
  sum += emitter_pdf(snapshot, emitter_of_world(snapshot, direction), receiver);
  // All surfaces on the ray: light sampling does not know which is in front.
  Ray rest = ray;
  Hit hit;
  for (int i = 0; i < 16 && snapshot.intersect(rest, GRADUS_VISIBLE_CAMERA, &hit); ++i) {
    const SurfacePoint point = snapshot.surface_point(hit);
    const EmitterPoint emitter = emitter_of_surface(snapshot, point);
    if (emitter.kind != EmitterKind::None) sum += emitter_pdf(snapshot, emitter, receiver);
    rest.origin = offset_origin(point, direction);
  }
  return sum;
}

void expect_matching(const Snapshot& snapshot, const Receiver& receiver, const Vec3& axis, uint32_t seed) {
  const auto sample = [&](const Vec2& u, const Vec2& v, Vec3* direction) {
    const EmitterPoint point = sample_emitter(snapshot, receiver, v.x, u);
    if (point.kind == EmitterKind::None) return false;
    const EmitterView view = view_emitter(snapshot, point, receiver);
    *direction = view.direction;
    return view.pdf > 0.0f;
  };
  ChiSquareOptions options;
  options.axis = axis;
  options.seed = seed;
  const ChiSquareResult result = chi_square_sphere(
      sample, [&](const Vec3& d) { return density(snapshot, receiver, d); }, options);
  EXPECT_TRUE(result.passed) << result.text;
  EXPECT_LE(result.mass, 1.01) << result.text;
  EXPECT_LE(result.zero_density_samples, 10u);
}

// Five receivers around a light at the origin that shines down.
const Receiver kReceivers[5] = {{Vec3(0, 0, -1), Vec3(0, 0, 1), false},
                                {Vec3(0.5f, 0.2f, -0.8f), Vec3(0, 0, 1), false},
                                {Vec3(-1, 0.4f, -0.5f), Vec3(0.6f, 0, 0.8f), false},
                                {Vec3(0.3f, 1.2f, -1.0f), Vec3(0, -1, 0), true},
                                {Vec3(-0.2f, -0.3f, -0.4f), Vec3(0, 0, 1), true}};

void expect_matching_light(const GradusLight& light) {
  TestScene scene;
  scene.lights({light});
  const auto snapshot = scene.commit();
  for (uint32_t i = 0; i < 5; ++i) {
    SCOPED_TRACE(i);
    expect_matching(*snapshot, kReceivers[i], glm::normalize(Vec3(0.2f, -0.3f, 1.0f)), i + 1);
  }
}

TEST(A3_LightSampling, Rectangle) {
  GradusLight light = make_light(GRADUS_LIGHT_RECTANGLE, Mat4(1.0f), Rgb(1.0f));
  light.size[0] = 1.5f;
  light.size[1] = 0.7f;
  expect_matching_light(light);
}

TEST(A3_LightSampling, Ellipse) {
  GradusLight light = make_light(GRADUS_LIGHT_ELLIPSE, Mat4(1.0f), Rgb(1.0f));
  light.size[0] = 1.5f;
  light.size[1] = 0.7f;
  expect_matching_light(light);
}

TEST(A3_LightSampling, Sphere) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, Mat4(1.0f), Rgb(1.0f));
  light.radius = 0.3f;
  expect_matching_light(light);
  light.radius = 2.0f;  // all receivers inside
  expect_matching_light(light);
}

TEST(A3_LightSampling, FacingDisk) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, Mat4(1.0f), Rgb(1.0f));
  light.flags = GRADUS_LIGHT_DISK_FACING;
  light.radius = 0.4f;
  expect_matching_light(light);
}

TEST(A3_LightSampling, Sun) {
  GradusLight light = make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(1.0f));
  light.angle = 0.8f;
  expect_matching_light(light);
}

// Few and large: the grid's 4×4 points cannot integrate the density of a triangle seen edge-on.
Soup folded_sheet(const Vec3& at, float size) {
  Soup soup;
  const Vec3 p[5] = {{-1, -1, 0.2f}, {1, -1, -0.2f}, {0.1f, 0, 0.4f}, {1, 1, 0.1f}, {-1, 1, 0}};
  for (const auto& t : {std::array{0, 1, 2}, std::array{1, 3, 2}, std::array{3, 4, 2}, std::array{4, 0, 2}})
    soup.triangle(at + size * p[t[0]], at + size * p[t[1]], at + size * p[t[2]]);
  return soup;
}

TEST(A3_LightSampling, EmissiveTriangles) {
  TestScene scene;
  scene.mesh(1, folded_sheet(Vec3(0.0f), 1.0f));
  scene.material(5, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f), 5.0f));
  scene.instance(1, scaling(Vec3(1, 1.5f, 0.5f)), GRADUS_VISIBLE_ALL, 5);
  const auto snapshot = scene.commit();
  for (uint32_t i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    expect_matching(*snapshot, kReceivers[i], glm::normalize(Vec3(0.2f, -0.3f, 1.0f)), i + 1);
  }
}

TEST(A3_EnvironmentSampling, ConstantMapAndManySizes) {
  for (const uint32_t size : {0u, 16u, 512u}) {
    TestScene scene;
    scene.material(6, MaterialDesc::colored_by_generated());
    scene.world(6, size);
    SCOPED_TRACE(size);
    expect_matching(*scene.commit(), kReceivers[0], glm::normalize(Vec3(0.5f, -0.3f, 1.0f)), size + 1);
  }
  TestScene scene;
  scene.material(6, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f)));
  scene.world(6);
  expect_matching(*scene.commit(), kReceivers[0], Vec3(0, 0, 1), 1);
}

TEST(A3_LightSampling, AllKindsTogether) {
  TestScene scene;
  GradusLight rectangle = make_light(GRADUS_LIGHT_RECTANGLE, translation(Vec3(0, 0, 1)), Rgb(1.0f));
  GradusLight sun = make_light(GRADUS_LIGHT_SUN, Mat4(1.0f), Rgb(1.0f));
  sun.angle = 0.5f;
  GradusLight ball = make_light(GRADUS_LIGHT_POINT, translation(Vec3(1, 0, 0)), Rgb(1.0f));
  ball.radius = 0.2f;
  scene.lights({rectangle, sun, ball});
  scene.mesh(1, folded_sheet(Vec3(-1, 0.5f, 0.4f), 0.4f));
  scene.material(5, MaterialDesc(GRADUS_OP_EMISSION, Rgb(1.0f), 5.0f));
  scene.material(6, MaterialDesc::colored_by_generated());
  scene.instance(1, Mat4(1.0f), GRADUS_VISIBLE_ALL, 5);
  scene.world(6);
  const auto snapshot = scene.commit();
  for (uint32_t i = 0; i < 2; ++i) {
    SCOPED_TRACE(i);
    expect_matching(*snapshot, kReceivers[i], glm::normalize(Vec3(0.2f, -0.3f, 1.0f)), i + 1);
  }
}

}  // namespace
}  // namespace gradus::test
