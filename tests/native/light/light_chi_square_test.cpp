// A3: directions of light sampling against its density, which is evaluated by rays (for all emitters that a ray in that
// direction meets).
#include <random>

#include <gtest/gtest.h>

#include "light/light_sampling.h"
#include "light/light_table.h"
#include "scene/scene_fixture.h"
#include "shading/program_builder.h"
#include "shading/shade.h"
#include "support/chi_square.h"

namespace gradus::test::light_chi_square_test {
namespace {

using gradus::test::chi_square_sphere;
using gradus::test::ChiSquareOptions;
using gradus::test::ChiSquareResult;

double density(const scene::Snapshot& snapshot, const light::Receiver& receiver, const Vec3& direction) {
  double sum = 0.0;
  const Ray ray{receiver.position, 0.0f, direction, kInfinity};
  std::vector<light::LightHit> hits;
  light::intersect_lights(snapshot, ray, &hits);
  for (const light::LightHit& met : hits) sum += light::light_point_pdf(snapshot, met.point, receiver);
  sum += light::light_point_pdf(snapshot, light::light_point_of_world(snapshot, direction), receiver);
  // Adds the densities of all surfaces on the ray, because light sampling does not determine which is in front.
  Ray rest = ray;
  geometry::Hit hit;
  for (int i = 0; i < 16 && snapshot.intersect(rest, GRADUS_VISIBLE_CAMERA, &hit); ++i) {
    const geometry::SurfacePoint point = snapshot.surface_point(hit);
    const light::LightPoint light_point = light::light_point_of_surface(snapshot, point);
    if (light_point.kind != light::LightKind::None) sum += light::light_point_pdf(snapshot, light_point, receiver);
    rest.origin = geometry::offset_origin(point, direction);
  }
  return sum;
}

void expect_matching(const scene::Snapshot& snapshot, const light::Receiver& receiver, const Vec3& axis,
                     uint32_t seed) {
  const auto sample = [&](const Vec2& u, const Vec2& v, Vec3* direction) {
    light::LightPoint point;
    light::LightEvaluation sampled_view;
    light::sample_light_point(snapshot, receiver, v.x, u, &point, &sampled_view);
    if (point.kind == light::LightKind::None) return false;
    const light::LightEvaluation view = light::evaluate_light(snapshot, point, receiver);
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

// Five receivers around a light at the origin that emits downwards.
const light::Receiver kReceivers[5] = {{Vec3(0, 0, -1), Vec3(0, 0, 1), false},
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

// Directions to a world of one colour are sampled by the cosine, or uniformly if the receiver transmits light.
TEST(A3_LightSampling, UniformWorld) {
  TestScene scene;
  scene.material(1, MaterialDesc(GRADUS_OP_EMISSION, Rgb(0.5f)));
  scene.world(1);
  const auto snapshot = scene.commit();
  ASSERT_TRUE(snapshot->light_table->world.is_uniform());
  for (uint32_t i = 0; i < 5; ++i) {
    SCOPED_TRACE(i);
    expect_matching(*snapshot, kReceivers[i], kReceivers[i].normal, i + 1);
    const light::LightPoint up = light::light_point_of_world(*snapshot, kReceivers[i].normal);
    EXPECT_NEAR(light::light_point_pdf(*snapshot, up, kReceivers[i]), (kReceivers[i].transmits ? 0.25f : 1.0f) / kPi,
                1e-4f);
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

// The receivers see circles within the light, across its edge and beyond it.
TEST(A3_LightSampling, Spread) {
  for (const GradusLightType type : {GRADUS_LIGHT_RECTANGLE, GRADUS_LIGHT_ELLIPSE}) {
    for (const float spread : {1.1f, 1.8f, 2.4f}) {
      SCOPED_TRACE(spread);
      GradusLight light = make_light(type, Mat4(1.0f), Rgb(1.0f));
      light.size[0] = 1.9f;
      light.size[1] = 1.5f;
      light.spread = spread;
      expect_matching_light(light);
    }
  }
}

TEST(A3_LightSampling, Sphere) {
  GradusLight light = make_light(GRADUS_LIGHT_POINT, Mat4(1.0f), Rgb(1.0f));
  light.radius = 0.3f;
  expect_matching_light(light);
  light.radius = 2.0f;  // all receivers are inside
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

// Few and large triangles: the grid's 4×4 points cannot integrate the density of a triangle seen edge-on.
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

// Sets a sky with a sun of this angular size. scale: of the height of the coordinates; unless it is 1, the position of
// the sun is unknown.
void set_sky(TestScene* scene, float size, float elevation, float scale = 1.0f) {
  ProgramBuilder b;
  const int place = b.add(GRADUS_OP_TEX_COORD, {}, GRADUS_TEX_COORD_GENERATED);
  const int turned =
      b.add(GRADUS_OP_MAPPING, {In::from(place), In(Vec3(0.0f)), In(Vec3(0.3f, 0, 0.5f)), In(Vec3(1, 1, scale))},
            GRADUS_MAPPING_POINT);
  const int sky = b.add(GRADUS_OP_SKY, {In::from(turned)}, GRADUS_SKY_NISHITA, {elevation, 0.4f, size, 1, 0, 1, 1, 1});
  scene->scene.set_material(6, b.desc(b.add(GRADUS_OP_EMISSION, {In::from(sky), In(1.0f)})));
  scene->world(6);
}

TEST(A3_EnvironmentSampling, SkyWithSun) {
  // The rim of the sampled cone, which is slightly wider than the disc, lies between rows of the test's grid.
  const auto size_of = [](float rows) { return 2.0f * (rows * kPi / 80.0f - 1e-5f) / 1.001f; };
  const std::pair<float, float> suns[] = {{size_of(3.0f), 0.6f}, {size_of(14.0f), 0.05f}};  // size, elevation
  for (const auto& [size, elevation] : suns) {
    TestScene scene;
    set_sky(&scene, size, elevation);
    const auto snapshot = scene.commit();
    const auto& discs = snapshot->materials[snapshot->world_material]->suns;
    ASSERT_EQ(discs.size(), 1u);
    const Vec3 axis = discs[0].direction;
    for (uint32_t i = 0; i < 4; ++i) {
      SCOPED_TRACE(i);
      expect_matching(*snapshot, kReceivers[i], axis, i + 1);
    }
  }
}

// The sun is too small for the cells of the chi-square test: instead, the estimate that uses the density has to equal
// the sky's light, with little noise.
void expect_light(const scene::Snapshot& snapshot, float noise) {
  const light::Receiver receiver{Vec3(0.0f), Vec3(0, 0, 1), false};
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0f, 0.9999999f);
  constexpr int kCount = 20000;
  double sum = 0.0, squares = 0.0, grid = 0.0;
  for (int i = 0; i < kCount; ++i) {
    light::LightPoint point;
    light::LightEvaluation view;
    const Vec2 u(uniform(random), uniform(random));
    light::sample_light_point(snapshot, receiver, uniform(random), u, &point, &view);
    const double x = view.pdf > 0.0f ? double(view.radiance.x * std::max(view.direction.z, 0.0f) / view.pdf) : 0.0;
    sum += x;
    squares += x * x;
  }
  // Integrates over a dense grid over the hemisphere; about eight of the 2000 × 500 points lie in the sun.
  for (int y = 0; y < 500; ++y)
    for (int x = 0; x < 2000; ++x) {
      const float z = (float(y) + 0.5f) / 500.0f, phi = 2.0f * kPi * (float(x) + 0.5f) / 2000.0f,
                  s = std::sqrt(1.0f - z * z);
      grid +=
          double(z *
                 shading::shade_world(snapshot, Vec3(s * std::cos(phi), s * std::sin(phi), z), shading::RayState()).x) *
          2.0 * double(kPi) / 1e6;
    }
  const double mean = sum / kCount, deviation = std::sqrt(squares / kCount - mean * mean);
  EXPECT_LT(deviation, double(noise) * mean);
  EXPECT_NEAR(mean, grid, 0.25 * grid);
}

TEST(A3_EnvironmentSampling, SunOfEarthsSizeHasLittleNoise) {
  TestScene scene;
  set_sky(&scene, 0.0095f, 0.6f);
  expect_light(*scene.commit(), 0.6f);
}

TEST(A3_EnvironmentSampling, SunBehindAStretchedMappingIsFoundByTheMap) {
  TestScene scene;
  set_sky(&scene, 0.0095f, 0.6f, 1.001f);
  const auto snapshot = scene.commit();
  EXPECT_TRUE(snapshot->materials[snapshot->world_material]->suns.empty());
  expect_light(*snapshot, 4.0f);
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
}  // namespace gradus::test::light_chi_square_test
