// A guide that points away from the light: the mean stays, and the second moment is bounded.
#include <cmath>

#include <gtest/gtest.h>

#include "integrator/guide_training.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::wrong_guide_test {
namespace {

// Where there is no light.
const Vec3 kDarkCorner(-0.95f, -0.95f, 0.95f);

// What the walls are like. With kinds, a wall is diffuse and glossy in one class, and only diffuse rays see the wall
// before the light, so that the kind of a bounce is sampled.
enum class Walls { Diffuse, Kinds };

// Builds a white room that is lit over a wall, so that most light comes by several bounces.
void build(Walls walls, test::PathScene* scene) {
  test::Surface surface = test::matte(Rgb(walls == Walls::Diffuse ? 0.9f : 0.5f));
  if (walls == Walls::Kinds) {
    surface.glossy = Rgb(0.4f);
    surface.glossy_roughness = 0.6f;  // of class Diffuse
  }
  test::add_box(scene, surface);
  const uint64_t white = scene->material(test::matte(Rgb(0.9f)));
  test::Surface light;
  light.emission = Rgb(30.0f);
  const uint32_t hidden = walls == Walls::Kinds ? uint32_t{GRADUS_VISIBLE_GLOSSY} : 0u;
  scene->quad(Vec3(0.3f, -1, -1), Vec3(0, 0, 2), Vec3(0, 1.4f, 0), white, GRADUS_VISIBLE_ALL & ~hidden);
  scene->quad(Vec3(0.35f, -0.9f, -0.9f), Vec3(0, 0, 1.8f), Vec3(0.6f, 0, 0), scene->material(light));
}

// Returns what all surfaces would learn if light came from the dark corner alone.
std::shared_ptr<const guide::GuidingField> make_wrong_field() {
  test::Random random(3);
  std::vector<guide::TrainingSample> samples;
  for (int i = 0; i < 60000; ++i) {
    guide::TrainingSample s;
    for (int k = 0; k < 3; ++k) s.position[k] = 2.0f * random.get() - 1.0f;
    s.normal[i % 3] = i % 2 == 0 ? 1.0f : -1.0f;
    const Vec3 to = kDarkCorner - s.position;
    s.distance = glm::length(to);
    s.direction = to / s.distance;
    s.pdf = glm::dot(s.direction, s.normal) * kInvPi;
    s.radiance = 1.0f;
    if (s.pdf > 0.0f) samples.push_back(s);
  }
  return std::make_shared<const guide::GuidingField>(std::move(samples));
}

class WrongGuide : public testing::TestWithParam<Walls> {};

TEST_P(WrongGuide, BoundsTheVariance) {
  test::PathScene scene;
  build(GetParam(), &scene);
  const std::shared_ptr<const guide::GuidingField> field = make_wrong_field();
  ASSERT_GT(field->guided_share(), 0.9f);
  test::Moments moments[2];
  for (uint32_t seed = 0; seed < (test::full_run() ? 600 : 100); ++seed) {
    for (const bool is_guided : {false, true}) {
      GradusSettings settings = test::test_settings(12, 12);
      settings.seed = 2 * seed + (is_guided ? 1 : 0);
      settings.independent_sampler = 1;
      settings.max_bounces = settings.diffuse_bounces = 10;
      integrator::IntegratorContext c = scene.context(settings);
      if (is_guided) c.snapshot = integrator::guided_snapshot(*c.snapshot, field);
      film::Film film = test::make_test_film(c.settings, false);
      test::sample_film(*integrator::make_path_integrator(c), 0, 32, &film);
      moments[is_guided].add(film::read_images(film, 0).primal);
    }
  }
  double plain = 0.0, guided = 0.0, difference = 0.0, sum = 0.0;
  for (size_t i = 0; i < moments[0].size(); ++i) {
    plain += moments[0].variance_of_mean(i);
    guided += moments[1].variance_of_mean(i);
    difference += moments[1].mean(i) - moments[0].mean(i);
    sum += moments[0].mean(i);
  }
  std::printf("  variance with the guide over that without: %.2f, mean %+.2f %%\n", guided / plain,
              100.0 * difference / sum);
  EXPECT_GT(guided, 1.2 * plain) << "the guide is used";
  // The bound of the second moment is 4.
  EXPECT_LT(guided, 2.6 * plain);
  // Channels of a pixel share their paths.
  EXPECT_LT(std::fabs(difference), 5.0 * std::sqrt(3.0 * (plain + guided)));
}

INSTANTIATE_TEST_SUITE_P(All, WrongGuide, testing::Values(Walls::Diffuse, Walls::Kinds));

}  // namespace
}  // namespace gradus::wrong_guide_test
