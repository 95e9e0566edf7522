// Regression tests: differences of two pixels that were biased, each for a different cause.
#include <cmath>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/path_scene.h"

namespace gradus::gradient_bias_test {
namespace {

using test::PathScene;
using test::Surface;

// Checks that the sampled difference of two pixels agrees in the mean with the difference of their images.
void check_difference(PathScene* scene, GradusSettings settings, uint32_t samples) {
  constexpr int renders = 300;
  test::sample_at_pixel_centres(&settings);
  integrator::IntegratorContext context = scene->context(settings);
  double sum = 0.0, squares = 0.0;
  for (uint32_t seed = 0; seed < renders; ++seed) {
    context.settings.seed = seed;
    film::Film film = test::make_test_film(context.settings, true);
    test::sample_film(*gradient::make_gradient_integrator(context), 0, samples, &film);
    const film::GradientImages images = film::read_images(film, 0);
    const double off = images.dx[0] - (double(images.primal[3]) - double(images.primal[0]));
    sum += off;
    squares += off * off;
  }
  const double mean = sum / renders, error = std::sqrt((squares / renders - mean * mean) / renders);
  std::printf("  off by %.4g ± %.2g\n", mean, error);
  EXPECT_GT(error, 0.0);
  EXPECT_LT(std::fabs(mean), 4.0 * error);
}

// Regression: where the classes of base and offset differ, light samples behind the next shared vertex were paired by
// themselves. But BSDF samples that met the same emitter were weighted by the density of both techniques.
TEST(B7_EdgeOfAMirror, EmittersBehindTheNextVertexHaveTheSameWeightInBothTechniques) {
  PathScene scene;
  Surface left = test::matte(Rgb(0.8f)), right = left, metal, light;
  right.glossy = Rgb(0.3f);
  metal.glossy = Rgb(0.9f);
  metal.glossy_roughness = 0.34f;
  light.emission = Rgb(10.0f);
  scene.quad(Vec3(-1, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -2), scene.material(left));
  scene.quad(Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -2), scene.material(right));
  scene.quad(Vec3(-3, 1, -3), Vec3(6, 0, 0), Vec3(0, 0, 6), scene.material(metal));
  scene.quad(Vec3(-3.2f, -0.1f, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), scene.material(light));
  scene.camera(Vec3(0, 0.9f, 0), Vec3(0), 1.0f);
  GradusSettings settings = test::test_settings(2, 1);
  settings.max_bounces = 1;
  check_difference(&scene, settings, 1024);
}

// Adds a floor below a second transparent plane; a veil covers its left half. The light comes from above the second
// plane.
void add_veiled_floor(PathScene* scene) {
  Surface veil = test::matte(Rgb(0.05f));
  veil.transparent = 0.9f;
  const uint64_t wall = scene->material(test::matte(Rgb(0.8f))), veils = scene->material(veil);
  scene->quad(Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2), wall);
  scene->quad(Vec3(-1, 0, -1), Vec3(2, 0, 0), Vec3(0, 1.5f, 0), wall);
  scene->quad(Vec3(-1, 0.05f, 0.3f), Vec3(1, 0, 0), Vec3(0, 0.8f, 0), veils);
  scene->quad(Vec3(-1, 1.3f, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), veils);
  scene->camera(Vec3(0, 0.4f, 1.2f), Vec3(0), 0.3f);
}

// Checks a scene in which shadow rays pass one veil, and paths one or two.
void check_limits(PathScene* scene) {
  for (const uint32_t more : {0u, 1u}) {
    SCOPED_TRACE(more);
    GradusSettings settings = test::test_settings(2, 1);
    settings.max_bounces = 2;
    settings.transparent_max_bounces = 1;
    settings.one_more_transparent = more;
    check_difference(scene, settings, 512);
  }
}

// Regression: a path that has passed the first veil gets no light through the second. Its gradient sample used the
// light of its base.
TEST(B7_LimitOfTransparentSurfaces, AppliesToTheLightOfSharedVertices) {
  PathScene scene;
  add_veiled_floor(&scene);
  Surface light;
  light.emission = Rgb(10.0f);
  scene.quad(Vec3(-1, 1.5f, -0.5f), Vec3(2, 0, 0), Vec3(0, 0, 1), scene.material(light));
  check_limits(&scene);
}

TEST(B7_LimitOfTransparentSurfaces, AppliesToLightsThatSharedRaysMeet) {
  PathScene scene;
  add_veiled_floor(&scene);
  GradusLight ball = test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(0, 1.8f, 0)), Rgb(1.0f));
  ball.radius = 0.4f;
  scene.light(ball);
  check_limits(&scene);
}

// Adds a glossy floor, whose left half is also matte, below two metal walls and a light. Behind the floor, walls are
// blurred, and the blurs of the paths of two pixels often differ.
void add_metal_walls(PathScene* scene) {
  Surface left = test::matte(Rgb(0.3f)), right, metal, light;
  left.glossy = right.glossy = Rgb(0.6f);
  left.glossy_roughness = right.glossy_roughness = 0.35f;
  metal.glossy = Rgb(0.9f);
  metal.glossy_roughness = 0.25f;
  light.emission = Rgb(10.0f);
  const uint64_t walls = scene->material(metal);
  scene->quad(Vec3(-1, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -2), scene->material(left));
  scene->quad(Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -2), scene->material(right));
  scene->quad(Vec3(-1, -1, -0.7f), Vec3(2, 0, 0), Vec3(0, 3, 0), walls);
  scene->quad(Vec3(-1, -1, 0.7f), Vec3(2, 0, 0), Vec3(0, 3, 0), walls);
  scene->quad(Vec3(-0.5f, 1.8f, -0.5f), Vec3(1, 0, 0), Vec3(0, 0, 1), scene->material(light));
  scene->camera(Vec3(0, 0.6f, 0.6f), Vec3(0), 0.8f);
}

// Each path is shaded with blurs of its own, and a shift ends where they differ behind the joint.
TEST(B7_FilterGlossy, IsThatOfEachPath) {
  PathScene scene;
  add_metal_walls(&scene);
  GradusSettings settings = test::test_settings(2, 1);
  settings.max_bounces = 3;
  settings.blur_glossy = 1.0f;
  check_difference(&scene, settings, 4096);
}

TEST(B7_Caustics, AreLeftOutOfBothPaths) {
  PathScene scene;
  add_metal_walls(&scene);
  GradusSettings settings = test::test_settings(2, 1);
  settings.max_bounces = 3;
  settings.caustics_reflective = 0;
  check_difference(&scene, settings, 512);
}

}  // namespace
}  // namespace gradus::gradient_bias_test
