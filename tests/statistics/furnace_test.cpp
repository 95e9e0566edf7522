// A1: inside a sphere of albedo 0.5 the radiance is 1 everywhere, for every integrator, sampler and camera.
#include <tuple>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::furnace_test {
namespace {

enum class Lighting { Point, FourPoints, Emission };

// Lighting, camera, whether the integrator is the gradient integrator, whether the sampler is independent.
using Case = std::tuple<Lighting, GradusCameraType, bool, bool>;

GradusLight point_at_centre(float intensity) {
  return test::make_light(GRADUS_LIGHT_POINT, Mat4(1.0f), Rgb(intensity));
}

void build_sphere(Lighting lighting, GradusCameraType camera, test::PathScene* scene) {
  test::Surface surface;
  surface.diffuse = Rgb(0.5f);
  surface.emission = lighting == Lighting::Emission ? Rgb(0.5f) : Rgb(0.0f);
  scene->ball(Vec3(0.0f), 1.0f, scene->material(surface), 64);
  // Intensity π gives irradiance π on the sphere, which reflects radiance 0.5. All bounces together give 0.5/(1 − 0.5)
  // = 1.
  for (int i = 0; i < (lighting == Lighting::Point ? 1 : lighting == Lighting::FourPoints ? 4 : 0); ++i) {
    scene->light(point_at_centre(lighting == Lighting::Point ? kPi : 0.25f * kPi));
  }
  scene->camera(Vec3(0.0f), Vec3(0.0f, 0.0f, -1.0f), camera == GRADUS_CAMERA_PERSPECTIVE ? 1.0f : 0.5f, camera);
}

class A1_Furnace : public testing::TestWithParam<Case> {};

TEST_P(A1_Furnace, RadianceIsOne) {
  const auto [lighting, camera, gradient, independent] = GetParam();
  test::PathScene scene;
  build_sphere(lighting, camera, &scene);
  GradusSettings settings = test::test_settings(10, 10);
  settings.independent_sampler = independent ? 1 : 0;
  const integrator::IntegratorContext context = scene.context(settings);
  film::Film film = test::make_test_film(settings, gradient);
  test::sample_film(
      gradient ? *gradient::make_gradient_integrator(context) : *integrator::make_path_integrator(context), 0,
      test::full_run() ? 256 : 64, &film);
  const film::GradientImages images = film::read_images(film, 0);
  double sum = 0.0;
  for (float value : images.primal) sum += value;
  EXPECT_NEAR(sum / double(images.primal.size()), 1.0, 0.025);
  // The image is constant except for the facets of the sphere, so its gradients are 0.
  double slope = 0.0;
  for (float value : images.dx) slope += value;
  for (float value : images.dy) slope += value;
  EXPECT_NEAR(slope / double(images.primal.size()), 0.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(All, A1_Furnace,
                         testing::Combine(testing::Values(Lighting::Point, Lighting::FourPoints, Lighting::Emission),
                                          testing::Values(GRADUS_CAMERA_PERSPECTIVE, GRADUS_CAMERA_ORTHOGRAPHIC),
                                          testing::Bool(), testing::Bool()));

}  // namespace
}  // namespace gradus::furnace_test
