// Light passes add up to the noisy image; data passes follow Blender's conventions.
#include <cmath>

#include <gtest/gtest.h>

#include "film/film.h"
#include "gradient/gradient_integrator.h"
#include "output/pass_read.h"
#include "render/render.h"
#include "schema/pass_table.h"
#include "shading/program_builder.h"
#include "support/light_sum.h"
#include "support/path_scene.h"

namespace gradus::passes_test {
namespace {

using test::Scenario;

constexpr uint64_t kAllPasses = (uint64_t{1} << GRADUS_PASS_COUNT) - 1;

std::vector<float> read(const film::Film& film, uint32_t pass) {
  std::vector<float> pixels(static_cast<size_t>(film.region.area()) * schema::pass_info(pass).channels);
  output::read_film_pass(film, pass, film.region, pixels.data());
  return pixels;
}

// Samples a film with room for gradients, in which plain paths have the jitter of gradient paths.
film::Film render_passes(test::PathScene* scene, bool gradient) {
  GradusSettings settings = test::test_settings(24, 20);
  settings.passes = kAllPasses;
  const integrator::IntegratorContext context = scene->context(settings);
  film::Film film = test::make_test_film(settings, true);
  film.settings = settings;
  film::add_pass_channels(settings.passes, &film);
  test::sample_film(
      gradient ? *gradient::make_gradient_integrator(context) : *integrator::make_path_integrator(context), 0, 8,
      &film);
  return film;
}

film::Film render_passes(Scenario scenario, bool gradient) {
  test::PathScene scene;
  test::build(scenario, &scene);
  return render_passes(&scene, gradient);
}

class Passes : public testing::TestWithParam<Scenario> {};

void expect_light_to_add_up(const film::Film& film) {
  test::expect_light_to_add_up([&](uint32_t pass) { return read(film, pass); }, read(film, GRADUS_PASS_NOISY_IMAGE));
  EXPECT_EQ(film.counters.nonfinite_feature, 0u);
}

TEST_P(Passes, LightAddsUpToTheNoisyImage) { expect_light_to_add_up(render_passes(GetParam(), true)); }

// Regression: a share of a negative sum was written to Diffuse, which a metal does not have.
TEST(LightPasses, LightBelowZeroAddsUpToo) {
  test::PathScene scene;
  test::add_box(&scene, test::matte(Rgb(0.6f)));
  test::add_ceiling_light(&scene, -8.0f, 0.6f);
  scene.ball(Vec3(0.0f, -0.3f, 0.0f), 0.6f, scene.material(test::glossy(0.5f)), 10, true);
  expect_light_to_add_up(render_passes(&scene, true));
}

TEST_P(Passes, PlainAndGradientTracingGiveTheSame) {
  const film::Film plain = render_passes(GetParam(), false);
  const film::Film gradient = render_passes(GetParam(), true);
  for (size_t i = 0; i < plain.channels.size(); ++i) {
    EXPECT_EQ(plain.channels[i].values, gradient.channels[i].values) << schema::pass_info(plain.channels[i].pass).name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Passes,
                         testing::Values(Scenario::DiffuseArea, Scenario::World, Scenario::GlossyFloor, Scenario::Glass,
                                         Scenario::RoughGlass, Scenario::Transparent, Scenario::LightsSeen),
                         [](const testing::TestParamInfo<Scenario>& info) { return test::name_of(info.param); });

TEST(DataPasses, DepthIsPlanarAndBackgroundFar) {
  const film::Film film = render_passes(Scenario::World, false);
  const std::vector<float> depth = read(film, GRADUS_PASS_DEPTH);
  // The back wall is perpendicular to the camera's axis, at a distance of 4.2 m.
  EXPECT_NEAR(depth[film.index(12, 12)], 4.2f, 1e-4f);
  EXPECT_NEAR(depth[film.index(10, 13)], 4.2f, 1e-4f);
  EXPECT_EQ(depth[film.index(0, 0)], 1e10f);
}

TEST(DataPasses, NothingMovesInAStaticScene) {
  const film::Film film = render_passes(Scenario::World, false);
  for (float v : read(film, GRADUS_PASS_VECTOR)) EXPECT_EQ(v, 0.0f);
}

TEST(DataPasses, NormalsFaceTheViewer) {
  const film::Film film = render_passes(Scenario::DiffuseArea, false);
  const std::vector<float> normal = read(film, GRADUS_PASS_NORMAL);
  const size_t i = 3 * film.index(12, 12);
  EXPECT_NEAR(normal[i], 0.0f, 1e-5f);
  EXPECT_NEAR(normal[i + 1], 0.0f, 1e-5f);
  EXPECT_NEAR(normal[i + 2], 1.0f, 1e-5f);
}

// Regression: the alpha of an opaque film was 1 everywhere. In Cycles, a holdout object or shader makes an opaque film
// transparent, and the world is visible elsewhere.
TEST(Holdout, IsTransparentInAnOpaqueFilmToo) {
  test::PathScene scene;
  test::ProgramBuilder program;
  const uint64_t shader = scene.material(program.desc(program.add(GRADUS_OP_HOLDOUT, {}))),
                 wall = scene.material(test::matte(Rgb(0.8f)));
  scene.quad(Vec3(-1, -0.5f, 0), Vec3(0.5f, 0, 0), Vec3(0, 1, 0), wall);
  scene.quad(Vec3(-0.5f, -0.5f, 0), Vec3(0.5f, 0, 0), Vec3(0, 1, 0), wall, GRADUS_VISIBLE_ALL | GRADUS_HOLDOUT);
  scene.quad(Vec3(0, -0.5f, 0), Vec3(0.5f, 0, 0), Vec3(0, 1, 0), shader);
  scene.camera(Vec3(0, 0, 3), Vec3(0, 0, 0), 2.0f / 3.0f);
  GradusSettings settings = test::test_settings(16, 4);
  settings.samples = 4;
  settings.filter_width = 0.01f;  // no pixel covers both sides of an edge
  const std::shared_ptr<const scene::Snapshot> snapshot = scene.context(settings).snapshot;
  for (const uint32_t integrator : {GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT}) {
    for (const uint32_t transparent : {0u, 1u}) {
      settings.integrator = integrator;
      settings.film_transparent = transparent;
      render::Render render(nullptr, snapshot, settings);
      ASSERT_TRUE(render.wait(-1.0));
      for (const uint32_t pass : {GRADUS_PASS_NOISY_IMAGE, GRADUS_PASS_COMBINED}) {
        std::vector<float> image(16 * 4 * 4);
        render.read_pass(pass, image.data(), image.size());
        const auto alpha = [&](int x) { return image[4 * (2 * 16 + size_t(x)) + 3]; };
        EXPECT_NEAR(alpha(2), 1.0f, 0.02f) << "wall";
        EXPECT_NEAR(alpha(6), 0.0f, 0.02f) << "object";
        EXPECT_NEAR(alpha(10), 0.0f, 0.02f) << "shader";
        EXPECT_NEAR(alpha(14), transparent ? 0.0f : 1.0f, 0.02f) << "world";
      }
    }
  }
}

}  // namespace
}  // namespace gradus::passes_test
