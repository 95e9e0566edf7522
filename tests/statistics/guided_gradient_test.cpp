// Gradient paths with a guide: their primal has the bits of plain paths, and sampled differences are those of images.
#include <cmath>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "integrator/guide_training.h"
#include "support/difference_statistics.h"
#include "support/path_scene.h"

namespace gradus::guided_gradient_test {
namespace {

using test::PathScene;
using test::Surface;

constexpr uint32_t kSide = 20;

enum class Case { Gap, GapByKind, GapGlossy, GlossyFloor, RoughMetal, Facets, Subsurface };
const char* const kNames[] = {"Gap", "GapByKind", "GapGlossy", "GlossyFloor", "RoughMetal", "Facets", "Subsurface"};

// Builds a box whose light is behind a wall, over which light comes to the camera's side.
void build_gap(PathScene* scene, const Surface& floor, uint32_t visibility = GRADUS_VISIBLE_ALL) {
  test::add_box(scene, floor);
  const uint64_t white = scene->material(test::matte(Rgb(0.7f)));
  Surface light;
  light.emission = Rgb(30.0f);
  scene->quad(Vec3(0.3f, -1, -1), Vec3(0, 0, 2), Vec3(0, 1.4f, 0), white, visibility);
  scene->quad(Vec3(0.3f, -1, 1), Vec3(0.7f, 0, 0), Vec3(0, 2, 0), white);
  scene->quad(Vec3(0.35f, -0.9f, -0.9f), Vec3(0, 0, 1.8f), Vec3(0.6f, 0, 0), scene->material(light));
  scene->ball(Vec3(-0.3f, -0.6f, 0.1f), 0.4f, scene->material(test::matte(Rgb(0.5f))), 6);
}

void build(Case c, PathScene* scene) {
  Surface floor = test::matte(Rgb(0.6f));
  if (c == Case::Gap) return build_gap(scene, floor);
  floor.diffuse = Rgb(0.4f);
  floor.glossy = Rgb(0.3f);
  floor.glossy_roughness = 0.6f;  // of class Diffuse
  if (c == Case::GapGlossy) return build_gap(scene, floor);
  // The kind of a bounce decides what it meets.
  if (c == Case::GapByKind) return build_gap(scene, floor, GRADUS_VISIBLE_ALL & ~GRADUS_VISIBLE_GLOSSY);
  test::build(c == Case::GlossyFloor  ? test::Scenario::GlossyFloor
              : c == Case::RoughMetal ? test::Scenario::RoughMetal
              : c == Case::Facets     ? test::Scenario::Facets
                                      : test::Scenario::Subsurface,
              scene);
}

class GuidedGradients : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    build(GetParam(), &scene_);
    std::atomic<uint64_t> cpu{0};
    const integrator::GuideTraining training =
        integrator::train_guide(plain_context(0), 60000, std::atomic<bool>{false}, &cpu);
    field_ = training.field;
    ASSERT_NE(field_, nullptr) << training.guided_share;
    EXPECT_NEAR(double(training.paths), 60000.0, 1000.0);
    EXPECT_GT(cpu, 0u);
  }
  integrator::IntegratorContext plain_context(uint32_t seed, bool independent = true) {
    GradusSettings settings = test::test_settings(kSide, kSide);
    settings.seed = seed;
    settings.independent_sampler = independent ? 1 : 0;
    if (GetParam() == Case::GapByKind) settings.diffuse_bounces = 2;
    if (GetParam() == Case::GapGlossy) settings.blur_glossy = 1.0f;
    return scene_.context(settings);
  }
  integrator::IntegratorContext context(uint32_t seed, bool independent = true) {
    integrator::IntegratorContext c = plain_context(seed, independent);
    c.snapshot = integrator::guided_snapshot(*c.snapshot, field_);
    return c;
  }
  PathScene scene_;
  std::shared_ptr<const guide::GuidingField> field_;
};

TEST_P(GuidedGradients, PrimalOfBothIntegratorsIsBitEqual) {
  const integrator::IntegratorContext c = context(1, false);
  film::Film plain = test::make_test_film(c.settings, true);  // with the jitter of gradient paths
  film::Film gradient = test::make_test_film(c.settings, true), unguided = test::make_test_film(c.settings, true);
  test::sample_film(*integrator::make_path_integrator(c), 0, 16, &plain);
  test::sample_film(*gradient::make_gradient_integrator(c), 0, 16, &gradient);
  test::sample_film(*integrator::make_path_integrator(plain_context(1, false)), 0, 16, &unguided);
  for (int half = 0; half < film::kHalves; ++half)
    EXPECT_EQ(plain.components[0].primal[half], gradient.components[0].primal[half]);
  EXPECT_NE(plain.components[0].primal[0], unguided.components[0].primal[0]) << "paths are guided";
  EXPECT_EQ(gradient.counters.nonfinite_radiance + gradient.counters.nonfinite_gradient, 0u);
}

TEST_P(GuidedGradients, B7_GradientsAreDifferencesOfTheImage) {
  test::BothDirections differences;
  for (uint32_t seed = 100; seed < 124; ++seed) {
    const integrator::IntegratorContext c = context(seed);
    film::Film film = test::make_test_film(c.settings, true);
    test::sample_film(*gradient::make_gradient_integrator(c), 0, 24, &film);
    differences.add(film::read_images(film, 0));
  }
  differences.check();
}

// Checks that the mean of the image is that without the guide.
TEST_P(GuidedGradients, MeanIsThatWithoutTheGuide) {
  test::Moments guided, plain;
  for (uint32_t seed = 200; seed < (test::full_run() ? 440 : 224); ++seed) {
    for (const bool is_guided : {false, true}) {
      const integrator::IntegratorContext c = is_guided ? context(seed) : plain_context(seed + 1000);
      film::Film film = test::make_test_film(c.settings, false);
      test::sample_film(*integrator::make_path_integrator(c), 0, 32, &film);
      (is_guided ? guided : plain).add({float(test::mean(film::read_images(film, 0).primal))});
    }
  }
  std::printf("  guided %.5f ± %.2g, plain %.5f ± %.2g\n", guided.mean(0), std::sqrt(guided.variance_of_mean(0)),
              plain.mean(0), std::sqrt(plain.variance_of_mean(0)));
  EXPECT_GT(test::welch_p(guided, plain, 0), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(All, GuidedGradients,
                         testing::Values(Case::Gap, Case::GapByKind, Case::GapGlossy, Case::GlossyFloor,
                                         Case::RoughMetal, Case::Facets, Case::Subsurface),
                         [](const testing::TestParamInfo<Case>& info) { return kNames[int(info.param)]; });

}  // namespace
}  // namespace gradus::guided_gradient_test
