// Features describe the first surface that is not a mirror or clear glass, or an emitter seen before it.
#include "film/features.h"

#include <gtest/gtest.h>

#include "film/film.h"
#include "gradient/gradient_integrator.h"
#include "schema/pass_table.h"
#include "support/path_scene.h"

namespace gradus::features_test {
namespace {

using test::PathScene;

// A camera at the origin that looks along -z with a very small field of view.
struct View {
  PathScene scene;
  GradusSettings settings = test::test_settings(4, 4);
  View() { scene.camera(Vec3(0.0f), Vec3(0, 0, -1), 0.01f); }

  // Adds a square of 4 m that faces the camera or has its back to it.
  void wall(float z, const test::Surface& surface) {
    scene.quad(Vec3(-2, -2, z), Vec3(4, 0, 0), Vec3(0, 4, 0), scene.material(surface));
  }

  film::Film render(bool gradient, uint32_t samples) {
    const integrator::IntegratorContext context = scene.context(settings);
    film::Film film = test::make_test_film(settings, gradient);
    film::add_pass_channels(schema::feature_passes(), &film);
    test::sample_film(
        gradient ? *gradient::make_gradient_integrator(context) : *integrator::make_path_integrator(context), 0,
        samples, &film);
    return film;
  }
};

void expect_near(const film::FeatureImage& image, size_t pixel, const std::vector<float>& expected, float tolerance) {
  for (size_t c = 0; c < expected.size(); ++c) {
    EXPECT_NEAR(image.values[pixel * image.channels + c], expected[c], tolerance) << "channel " << c;
  }
}

class SeenFeatures : public ::testing::TestWithParam<bool> {};  // parameter: with the gradient integrator

TEST_P(SeenFeatures, BehindAMirrorAreThoseOfTheMirroredObject) {
  View view;
  view.wall(-1.0f, test::glossy(0.0f));  // its colour is 0.8, 0.7, 0.6
  view.wall(2.0f, test::matte(Rgb(0.2f, 0.5f, 0.3f)));
  const film::Features features = film::read_features(view.render(GetParam(), 8));
  for (size_t i = 0; i < 16; ++i) {
    expect_near(features.albedo, i, {0.16f, 0.35f, 0.18f}, 1e-5f);
    expect_near(features.normal, i, {0.0f, 0.0f, -1.0f}, 1e-5f);
    expect_near(features.depth, i, {4.0f}, 1e-3f);
    expect_near({3, features.albedo.variance, {}}, i, {0.0f, 0.0f, 0.0f}, 1e-10f);
  }
}

// Regression: the features of the sky, seen directly or in a mirror, were black.
TEST_P(SeenFeatures, OfTheSkyAreItsLight) {
  View view;
  view.scene.world(Rgb(0.3f, 0.4f, 5.0f));
  film::Features features = film::read_features(view.render(GetParam(), 8));
  expect_near(features.albedo, 5, {0.3f, 0.4f, 1.0f}, 1e-6f);
  expect_near(features.normal, 5, {0.0f, 0.0f, 0.0f}, 0.0f);
  expect_near(features.depth, 5, {0.0f}, 0.0f);
  view.wall(-1.0f, test::glossy(0.0f));
  features = film::read_features(view.render(GetParam(), 8));
  expect_near(features.albedo, 5, {0.24f, 0.28f, 1.0f}, 1e-6f);
  expect_near(features.normal, 5, {0.0f, 0.0f, 0.0f}, 0.0f);
}

TEST_P(SeenFeatures, OfASkyThatTheFilmHidesAreZero) {
  View view;
  view.scene.world(Rgb(0.3f, 0.4f, 5.0f));
  view.settings.film_transparent = 1;
  expect_near(film::read_features(view.render(GetParam(), 8)).albedo, 5, {0.0f, 0.0f, 0.0f}, 0.0f);
}

TEST_P(SeenFeatures, OfAnEmissiveSurfaceAreItsLightAndItsShape) {
  test::Surface light;
  light.emission = Rgb(0.5f, 0.2f, 7.0f);
  View view;
  view.wall(-1.0f, light);
  const film::Features features = film::read_features(view.render(GetParam(), 8));
  expect_near(features.albedo, 5, {0.5f, 0.2f, 1.0f}, 1e-6f);
  expect_near(features.normal, 5, {0.0f, 0.0f, 1.0f}, 1e-5f);
  expect_near(features.depth, 5, {1.0f}, 1e-3f);
}

// Lights do not stop rays: the surface behind gives the shape.
TEST_P(SeenFeatures, OfALightAreItsLightAndTheShapeOfTheWall) {
  View view;
  view.wall(-2.0f, test::matte(Rgb(0.25f)));
  GradusLight light = test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(0, 0, -1)), Rgb(100.0f));
  light.radius = 0.1f;
  view.scene.light(light);
  const film::Features features = film::read_features(view.render(GetParam(), 8));
  expect_near(features.albedo, 5, {1.0f, 1.0f, 1.0f}, 1e-6f);
  expect_near(features.depth, 5, {2.0f}, 1e-3f);
}

// A path passes a surface at random; the mean is weighted by the surface's opacity.
TEST_P(SeenFeatures, OfTransparentSurfacesAreMixedByTheirOpacity) {
  for (const float transparent : {0.5f, 0.9f}) {
    test::Surface veil = test::matte(Rgb(0.5f, 0.4f, 0.3f));
    veil.transparent = transparent;
    View view;
    view.wall(-1.0f, veil);
    view.wall(-2.0f, test::matte(Rgb(0.1f, 0.6f, 0.9f)));
    const film::Features features = film::read_features(view.render(GetParam(), 64));
    double albedo = 0.0, depth = 0.0, variance = 0.0;
    for (size_t i = 0; i < 16; ++i) {
      albedo += features.albedo.values[3 * i + 2] / 16.0;
      depth += features.depth.values[i] / 16.0;
      variance += features.depth.variance[i] / 16.0;
    }
    const double spread = std::sqrt(transparent * (1.0 - transparent) / 1024.0);
    EXPECT_NEAR(albedo, 0.3 * (1.0 - transparent) + 0.9 * transparent, 4.0 * 0.6 * spread);
    EXPECT_NEAR(depth, 1.0 + transparent, 4.0 * spread);
    EXPECT_GT(variance, 0.0);
  }
}

TEST_P(SeenFeatures, GoToTheHalfBufferOfTheirSample) {
  View view;
  view.wall(-1.0f, test::matte(Rgb(0.5f)));
  for (const uint32_t samples : {1u, 2u}) {
    const film::Film film = view.render(GetParam(), samples);
    for (const film::Channel& plane : film.channels) {
      const std::vector<float> none(plane.values[0].size());
      EXPECT_NE(plane.values[0], none) << schema::pass_info(plane.pass).name;
      EXPECT_EQ(plane.values[1] == none, samples == 1) << schema::pass_info(plane.pass).name;
    }
  }
}

// Regression: the last ray of each path was traced to its end, although the features were complete.
TEST_P(SeenFeatures, CostNoRaysAndChangeNoBit) {
  View view;
  test::build(test::Scenario::World, &view.scene);
  view.settings = test::test_settings(24, 20);
  view.settings.max_bounces = 3;
  const film::Film film = view.render(GetParam(), 4);
  film::Film plain = test::make_test_film(view.settings, GetParam());
  const integrator::IntegratorContext context = view.scene.context(view.settings);
  ASSERT_TRUE(context.snapshot->features.only_lights_emit);
  test::sample_film(
      GetParam() ? *gradient::make_gradient_integrator(context) : *integrator::make_path_integrator(context), 0, 4,
      &plain);
  EXPECT_EQ(film.counters.rays_bounce, plain.counters.rays_bounce);
  EXPECT_EQ(film.components[0].primal, plain.components[0].primal);
  EXPECT_EQ(film.components[0].gradient, plain.components[0].gradient);
}

INSTANTIATE_TEST_SUITE_P(By, SeenFeatures, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& info) { return info.param ? "Gradients" : "Paths"; });

}  // namespace
}  // namespace gradus::features_test
