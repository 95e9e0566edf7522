// Compares the integrators with each other (the primal has the same bits) and sampled differences with differences of
// images (B3 and B7).
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "film/pixel_blocks.h"
#include "gradient/gradient_integrator.h"
#include "gradus/gradus_nodes.h"
#include "render/plan.h"
#include "shading/program_builder.h"
#include "support/difference_statistics.h"
#include "support/path_scene.h"

namespace gradus::gradient_test {
namespace {

using test::BothDirections;
using test::DifferenceStatistics;
using test::PathScene;
using test::Scenario;
using test::Surface;

// The image has more than one pixel block, each with jitter of its own.
constexpr uint32_t kWidth = 20;
constexpr uint32_t kHeight = 20;

class Scenarios : public testing::TestWithParam<Scenario> {
 protected:
  void SetUp() override { test::build(GetParam(), &scene_); }
  integrator::IntegratorContext context(uint32_t seed, bool independent = true) {
    GradusSettings settings = test::test_settings(kWidth, kHeight);
    settings.seed = seed;
    settings.independent_sampler = independent ? 1 : 0;
    if (GetParam() == Scenario::RoughMetal) {  // covers a wide filter and a lens, whose point base and offset share
      settings.pixel_filter = GRADUS_FILTER_BLACKMAN_HARRIS;
      settings.filter_width = 2.5f;
      scene_.camera_desc.aperture_radius = 0.1f;
      scene_.camera_desc.focus_distance = 3.0f;
    }
    settings.film_transparent = GetParam() == Scenario::World ? 1 : 0;  // covers gradients of alpha
    return scene_.context(settings);
  }
  // Checks the differences of films that sample(integrator, film) fills, one for each of 24 seeds.
  template <class Sample>
  void check_differences(uint32_t first_seed, Sample&& sample) {
    BothDirections differences;
    for (uint32_t seed = first_seed; seed < first_seed + 24; ++seed) {
      const integrator::IntegratorContext c = context(seed);
      film::Film film = test::make_test_film(c.settings, true);
      sample(*gradient::make_gradient_integrator(c), &film);
      differences.add(film::read_images(film, 0));
    }
    differences.check();
  }
  PathScene scene_;
};

TEST_P(Scenarios, PrimalOfBothIntegratorsIsBitEqual) {
  const integrator::IntegratorContext c = context(1, false);
  film::Film plain = test::make_test_film(c.settings, true);  // with the jitter of gradient paths
  film::Film gradient = test::make_test_film(c.settings, true);
  test::sample_film(*integrator::make_path_integrator(c), 0, 16, &plain);
  test::sample_film(*gradient::make_gradient_integrator(c), 0, 16, &gradient);
  for (int half = 0; half < film::kHalves; ++half) {
    EXPECT_EQ(plain.components[0].primal[half], gradient.components[0].primal[half]);
  }
  double sum = 0.0;
  for (const Radiance& r : plain.components[0].primal[0]) sum += r.x;
  EXPECT_GT(sum, 0.0);
  EXPECT_EQ(gradient.counters.nonfinite_radiance + gradient.counters.nonfinite_gradient, 0u);
}

TEST_P(Scenarios, B7_GradientsAreDifferencesOfTheImage) {
  BothDirections differences;
  film::Counters counters;
  for (uint32_t seed = 0; seed < 32; ++seed) {
    const integrator::IntegratorContext c = context(100 + seed);
    film::Film film = test::make_test_film(c.settings, true);
    test::sample_film(*gradient::make_gradient_integrator(c), 0, 24, &film);
    differences.add(film::read_images(film, 0));
    counters.add(film.counters);
  }
  differences.check();
  std::printf(
      "  shifts %lu: reconnected %lu, half-vector %lu, replayed %lu; failed: missed %lu occluded %lu class %lu tir %lu "
      "side %lu density "
      "%lu "
      "jacobian %lu\n",
      counters.shifts_attempted, counters.shifts_reconnected, counters.shifts_half_vector, counters.shifts_replayed,
      counters.fail_missed, counters.fail_occluded, counters.fail_class, counters.fail_total_reflection,
      counters.fail_side, counters.fail_density, counters.fail_jacobian);
}

// The planner skips half-vector shifts only in scenes in which no offset tries to copy an event of class R or T.
TEST_P(Scenarios, NoHalfVectorIsCopiedWhereThePlannerSkipsIt) {
  integrator::IntegratorContext c = context(1);
  c.settings.samples = 16;
  const render::Plan plan = render::make_plan(c.settings, *c.snapshot);
  const bool skipped = std::any_of(plan.skipped.begin(), plan.skipped.end(),
                                   [](const auto& entry) { return entry.first == "half-vector shifts"; });
  film::Film film = test::make_test_film(c.settings, true);
  test::sample_film(*gradient::make_gradient_integrator(c), 0, 16, &film);
  EXPECT_GT(film.counters.shifts_attempted, 0u);
  if (skipped) {
    EXPECT_EQ(film.counters.shifts_half_vector, 0u);
  }
  switch (GetParam()) {
    case Scenario::DiffuseArea:
    case Scenario::PointAndSun:
    case Scenario::World:
      EXPECT_TRUE(skipped);
      break;
    case Scenario::Mirror:
    case Scenario::Glass:
      EXPECT_FALSE(skipped);
      EXPECT_GT(film.counters.shifts_half_vector, 0u);
      break;
    default:
      break;
  }
}

// Checks differences of neighbours with different sample counts, some with none, over two batches.
TEST_P(Scenarios, B7_UnequalCounts) {
  check_differences(500, [](const integrator::Integrator& integrator, film::Film* film) {
    const std::atomic<bool> stop{false};
    std::vector<uint32_t> counts(static_cast<size_t>(film->region.area()));
    for (const uint32_t batch : {0u, 1u}) {
      for (size_t i = 0; i < counts.size(); ++i) counts[i] = batch == 0 ? 8 + 8 * (i % 3) : (i / 3 % 2 == 0 ? 0 : 32);
      integrator.sample(integrator::WorkUnit{film->region, 64 * batch, 0, &counts}, film, &film->counters, stop);
    }
  });
}

// Checks adaptive sampling: pixel blocks differ in their counts and in their sample numbers, even and odd.
TEST_P(Scenarios, B7_BlocksWithSampleNumbersOfTheirOwn) {
  check_differences(900, [](const integrator::Integrator& integrator, film::Film* film) {
    const std::atomic<bool> stop{false};
    std::vector<uint32_t> first(static_cast<size_t>(film->region.area())), count(first);
    for (const uint32_t batch : {0u, 1u}) {
      for (size_t i = 0; i < first.size(); ++i) {
        const bool right = int(i) % film->region.width() >= film::kPixelBlockSide,
                   low = int(i) / film->region.width() < film::kPixelBlockSide;
        first[i] += count[i];
        count[i] = batch == 0 ? (right ? 9 : 4) : (low ? 24 : 7);
      }
      integrator.sample(integrator::WorkUnit{film->region, 0, 0, &count, &first}, film, &film->counters, stop);
    }
  });
}

// Regression: a cancel between tiles leaves pairs whose ends have different numbers of samples. Their gradients were
// divided by the weight of whole batches and were too small.
TEST_P(Scenarios, B7_BatchCutShortByACancelKeepsTheScale) {
  check_differences(700, [](const integrator::Integrator& integrator, film::Film* film) {
    const std::atomic<bool> stop{false};
    test::sample_film(integrator, 0, 16, film);
    for (int32_t y = 0; y < static_cast<int32_t>(kHeight); ++y) {
      for (int32_t x = y % 2; x < static_cast<int32_t>(kWidth);
           x += 2) {  // covers every other pixel, so that every pair is incomplete
        integrator.sample(integrator::WorkUnit{Region{x, y, x + 1, y + 1}, 16, 16, nullptr}, film, &film->counters,
                          stop);
      }
    }
  });
}

// L3: the result has the same bits for any split into batches and tiles, in any order.
TEST_P(Scenarios, L3_BatchesAndTilesDoNotMatter) {
  const integrator::IntegratorContext c = context(3, false);
  const auto integrator = gradient::make_gradient_integrator(c);
  film::Film whole = test::make_test_film(c.settings, true);
  film::Film parts = test::make_test_film(c.settings, true);
  test::sample_film(*integrator, 0, 8, &whole);
  const std::atomic<bool> stop{false};
  for (uint32_t first : {0u, 2u}) {
    const uint32_t count = first == 0 ? 2 : 6;
    for (int32_t y = static_cast<int32_t>(kHeight); y > 0; y -= 5) {
      for (int32_t x = 0; x < static_cast<int32_t>(kWidth); x += 4) {
        integrator::WorkUnit unit{Region{x, y - 5, x + 4, y}, first, count, nullptr};
        integrator->sample(unit, &parts, &parts.counters, stop);
      }
    }
  }
  for (int half = 0; half < film::kHalves; ++half) {
    EXPECT_EQ(whole.components[0].primal[half], parts.components[0].primal[half]);
    EXPECT_EQ(whole.components[0].gradient[half], parts.components[0].gradient[half]);
    EXPECT_EQ(whole.pair_count[half], parts.pair_count[half]);
  }
}

// Renders a few distant pixels that get light by reflection in rough metal from an emitter that is hidden from them.
// The emitter is found with or without light sampling.
film::GradientImages light_over_metal(uint32_t seed, bool sampled_as_light) {
  PathScene scene;
  test::Surface floor;
  floor.diffuse = Rgb(0.8f);
  test::Surface metal;
  metal.glossy = Rgb(0.9f);
  metal.glossy_roughness = 0.4f;
  test::Surface light;
  light.emission = Rgb(40.0f);
  light.sampled_as_light = sampled_as_light;
  scene.quad(Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2), scene.material(floor));
  scene.quad(Vec3(-2, 1, -2), Vec3(4, 0, 0), Vec3(0, 0, 4), scene.material(metal));
  scene.quad(Vec3(-2.3f, -0.1f, -0.4f), Vec3(0.8f, 0, 0), Vec3(0, 0, 0.8f), scene.material(light));
  scene.camera(Vec3(0, 0.9f, 0), Vec3(0, 0, 0), 2.0f);
  GradusSettings settings = test::test_settings(4, 1);
  settings.seed = seed;
  settings.max_bounces = 1;
  test::sample_at_pixel_centres(&settings);
  const integrator::IntegratorContext c = scene.context(settings);
  film::Film film = test::make_test_film(c.settings, true);
  test::sample_film(*gradient::make_gradient_integrator(c), 0, 8192, &film);
  return film::read_images(film, 0);
}

// Regression: a reconnected offset scatters at the shared vertex with a density of its own, but a light that BSDF
// sampling found next was weighted with the base's density. Without light sampling there are no such weights, so the
// gradients with and without it must agree. They have much less noise than differences of images.
TEST(B7_SharedVertex, LightFoundBehindItIsWeightedByEachPathsOwnDensity) {
  DifferenceStatistics difference;
  for (uint32_t seed = 0; seed < 32; ++seed) {
    film::GradientImages images = light_over_metal(seed, true);
    const film::GradientImages plain = light_over_metal(1000 + seed, false);
    for (size_t i = 0; i < images.dx.size(); ++i) images.dx[i] -= plain.dx[i];
    std::fill(images.primal.begin(), images.primal.end(), 0.0f);
    difference.add(images, true);
  }
  difference.check("dx", 8);
}

// Both ends of a difference use the same point of the lens. An end seen through the centre of the lens would be sharp
// where the image is out of focus.
TEST(B7_Lens, DifferencesAreThoseOfTheBlurredImage) {
  PathScene scene;
  Surface light;
  light.emission = Rgb(1.0f);
  scene.quad(Vec3(-1.5f, -1.5f, 0), Vec3(1.5f, 0, 0), Vec3(0, 3, 0), scene.material(light));
  scene.camera(Vec3(0, 0, 3.2f), Vec3(0), 0.9f);
  scene.camera_desc.aperture_radius = 0.3f;
  scene.camera_desc.focus_distance = 1.5f;
  DifferenceStatistics difference;
  for (uint32_t seed = 0; seed < 32; ++seed) {
    GradusSettings settings = test::test_settings(kWidth, kHeight);
    settings.seed = seed;
    const integrator::IntegratorContext c = scene.context(settings);
    film::Film film = test::make_test_film(settings, true);
    test::sample_film(*gradient::make_gradient_integrator(c), 0, 16, &film);
    difference.add(film::read_images(film, 0), true);
  }
  difference.check("dx");
}

// One case in which light transport depends on the kind of a bounce.
struct KindCase {
  const char* name;
  uint32_t visibility = GRADUS_VISIBLE_ALL;  // visibility of the light
  int emission_kind = -1;
  uint32_t diffuse_bounces = 8;
};

class Kinds : public testing::TestWithParam<KindCase> {
 protected:
  // Renders a floor below a light and its reflection in a wall. Both halves of the floor scatter with the same class,
  // but one is mostly diffuse and the other mostly glossy.
  film::GradientImages image(uint32_t seed, bool sampled_as_light, uint32_t samples) {
    PathScene scene;
    test::Surface left, right, wall, light;
    left.diffuse = right.glossy = Rgb(0.7f, 0.6f, 0.5f);
    left.glossy = right.diffuse = Rgb(0.15f);
    left.glossy_roughness = right.glossy_roughness = 0.6f;
    wall.diffuse = Rgb(0.8f);
    light.emission = Rgb(6.0f);
    light.emission_kind = GetParam().emission_kind;
    light.sampled_as_light = sampled_as_light;
    scene.quad(Vec3(-1, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -2), scene.material(left));
    scene.quad(Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0, 0, -2), scene.material(right));
    scene.quad(Vec3(-1, 0, -1), Vec3(2, 0, 0), Vec3(0, 1.5f, 0), scene.material(wall));
    scene.quad(Vec3(-1, 1.6f, -0.8f), Vec3(2, 0, 0), Vec3(0, 0, 1), scene.material(light), GetParam().visibility);
    scene.camera(Vec3(0, 0.9f, 1.2f), Vec3(0, 0, 0), 0.6f);
    GradusSettings settings = test::test_settings(6, 3);
    settings.seed = seed;
    settings.independent_sampler = 1;
    settings.max_bounces = 3;
    settings.diffuse_bounces = GetParam().diffuse_bounces;
    const integrator::IntegratorContext c = scene.context(settings);
    film::Film film = test::make_test_film(c.settings, true);
    test::sample_film(*gradient::make_gradient_integrator(c), 0, samples, &film);
    return film::read_images(film, 0);
  }
};

// Regression: the lobe that produced a direction is part of the path, but no density contained its probability.
TEST_P(Kinds, B7_TheSampledLobeIsPartOfThePath) {
  DifferenceStatistics dx;
  for (uint32_t seed = 0; seed < 32; ++seed) dx.add(image(seed, true, 512), true);
  dx.check("dx", 40);
}

// Regression: light sampling and BSDF sampling saw different emissions, so the picture depended on the technique that
// found a light.
TEST_P(Kinds, B7_BothTechniquesSeeTheSameEmission) {
  DifferenceStatistics difference;
  for (uint32_t seed = 0; seed < 32; ++seed) {
    film::GradientImages images = image(5000 + seed, true, 512);
    images.dx = image(8000 + seed, false, 512).primal;
    for (size_t i = 0; i < images.dx.size(); ++i) images.dx[i] -= images.primal[i];
    std::fill(images.primal.begin(), images.primal.end(), 0.0f);
    difference.add(images, true);
  }
  difference.check("image", 40);
}

INSTANTIATE_TEST_SUITE_P(
    Integrators, Kinds,
    testing::Values(KindCase{"LimitOfDiffuseBounces", GRADUS_VISIBLE_ALL, -1, 0},
                    KindCase{"LightHiddenFromDiffuse", GRADUS_VISIBLE_ALL & ~GRADUS_VISIBLE_DIFFUSE},
                    KindCase{"EmissionForGlossyRays", GRADUS_VISIBLE_ALL, GRADUS_LIGHT_PATH_GLOSSY},
                    KindCase{"EmissionByDepth", GRADUS_VISIBLE_ALL, GRADUS_LIGHT_PATH_DIFFUSE_DEPTH}),
    [](const testing::TestParamInfo<KindCase>& info) { return std::string(info.param.name); });

// Two pixels, left and right, that look straight at a lit plane of two halves. The right half may be absent.
struct Halves {
  const char* name;
  Surface left;
  bool has_right;
  Surface right;
  enum { NoHoldout, Object, Shader } left_holdout = NoHoldout;
};

class Edges : public testing::TestWithParam<Halves> {
 protected:
  film::GradientImages image(uint32_t seed) const {
    PathScene scene;
    Surface light;
    light.emission = Rgb(6.0f);
    const bool has_holdout = GetParam().left_holdout != Halves::NoHoldout;
    const uint64_t left = GetParam().left_holdout == Halves::Shader ? holdout(&scene) : scene.material(GetParam().left);
    scene.quad(Vec3(-1, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), left,
               GetParam().left_holdout == Halves::Object ? GRADUS_VISIBLE_ALL | GRADUS_HOLDOUT : GRADUS_VISIBLE_ALL);
    if (GetParam().has_right) {
      scene.quad(Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), scene.material(GetParam().right));
    }
    scene.quad(Vec3(-1, -1, 2), Vec3(0, 2, 0), Vec3(2, 0, 0), scene.material(test::matte(Rgb(0.6f))),
               GRADUS_VISIBLE_ALL & ~GRADUS_VISIBLE_CAMERA);
    scene.quad(Vec3(-0.3f, 1.2f, 0.7f), Vec3(0.6f, 0, 0), Vec3(0, 0, 0.6f), scene.material(light));
    scene.camera(Vec3(0, 0, 3), Vec3(0, 0, 0), 0.4f);
    GradusSettings settings = test::test_settings(2, 1);
    settings.seed = seed;
    settings.max_bounces = 4;
    settings.film_transparent = has_holdout ? 1 : 0;
    const integrator::IntegratorContext c = scene.context(settings);
    film::Film film = test::make_test_film(c.settings, true);
    test::sample_film(*gradient::make_gradient_integrator(c), 0, 64, &film);
    return film::read_images(film, 0);
  }

 private:
  static uint64_t holdout(PathScene* scene) {
    test::ProgramBuilder p;
    return scene->material(p.desc(p.add(GRADUS_OP_HOLDOUT, {})));
  }
};

// Regression: where paths could not be shared across an edge, the reconstruction kept the contribution of a single path
// as a bright pixel.
TEST_P(Edges, B7_ADifferenceAcrossAnEdgeHasLessNoiseThanThatOfTheImage) {
  constexpr int renders = 400;
  double sum[3] = {}, squares[3] = {};
  for (uint32_t seed = 0; seed < renders; ++seed) {
    const film::GradientImages images = image(seed);
    const double sampled = images.dx[0], of_image = double(images.primal[images.channels]) - double(images.primal[0]);
    if (images.channels == 4) {
      EXPECT_EQ(images.dx[3], images.primal[7] - images.primal[3]);  // Alpha has no noise in this scene.
    }
    const double values[3] = {sampled, of_image, sampled - of_image};
    for (int i = 0; i < 3; ++i) {
      sum[i] += values[i];
      squares[i] += values[i] * values[i];
    }
  }
  const auto variance = [&](int i) { return squares[i] / renders - (sum[i] / renders) * (sum[i] / renders); };
  EXPECT_LT(variance(0), 0.75 * variance(1));  // The ideal ratio is 0.5, plus what the two sides share.
  EXPECT_LT(std::fabs(sum[2] / renders), 4.0 * std::sqrt(variance(2) / renders));
  std::printf("  variance %.3f of the image's, difference of means %.2f sigma\n", variance(0) / variance(1),
              sum[2] / renders / std::sqrt(variance(2) / renders));
}

Surface half_mirror() {
  Surface s = test::glossy(0.0f);
  s.glossy = Rgb(0.5f);
  s.diffuse = Rgb(0.3f);
  return s;
}

INSTANTIATE_TEST_SUITE_P(Integrators, Edges,
                         testing::Values(Halves{"OfTheScene", test::matte(Rgb(0.8f)), false, {}},
                                         Halves{"OfAMirror", test::glossy(0.0f), true, test::matte(Rgb(0.8f))},
                                         Halves{"OfAPolish", half_mirror(), true, test::matte(Rgb(0.8f))},
                                         Halves{"OfARoughness", test::glossy(0.0f), true, test::glossy(0.2f)},
                                         Halves{"OfGlass", test::glass(0.0f), true, test::matte(Rgb(0.8f))},
                                         Halves{"OfAHeldOutObject", test::matte(Rgb(0.8f)), true,
                                                test::matte(Rgb(0.8f)), Halves::Object},
                                         Halves{"OfAHoldoutShader", {}, true, test::matte(Rgb(0.8f)), Halves::Shader}),
                         [](const testing::TestParamInfo<Halves>& info) { return std::string(info.param.name); });

// Two pixels of a floor below a light, and an object that `add` places on or above the floor.
struct Above {
  const char* name;
  void (*add)(PathScene*);
  Surface floor;
  float maximum;  // maximum ratio of the variance of the sampled difference to that of the image's difference
};

uint64_t wall(PathScene* scene) { return scene->material(test::matte(Rgb(0.8f))); }
void add_mirror_ball(PathScene* scene) {
  scene->ball(Vec3(0.3f, 0.5f, 0), 0.2f, scene->material(test::glossy(0.0f)), 12, true);
}
void add_polished_ball(PathScene* scene) {
  scene->ball(Vec3(0.3f, 0.5f, 0), 0.2f, scene->material(test::glossy(0.25f)), 12, true);
}
void add_glass_ball(PathScene* scene) {
  scene->ball(Vec3(0.3f, 0.5f, 0), 0.2f, scene->material(test::glass(0.0f)), 12, true);
}
void add_mirror(PathScene* scene) {
  scene->quad(Vec3(0.4f, 0.2f, -0.2f), Vec3(0, 0, 0.4f), Vec3(0, 0.4f, 0), scene->material(test::glossy(0.0f)));
}
void add_mirror_on_the_floor(PathScene* scene) {
  scene->quad(Vec3(0.02f, 0, -0.2f), Vec3(0, 0, 0.4f), Vec3(0, 0.4f, 0), scene->material(test::glossy(0.0f)));
}
void add_polished_wall(PathScene* scene) {
  scene->quad(Vec3(0.4f, 0.0f, -0.5f), Vec3(0, 0, 1), Vec3(0, 1, 0), scene->material(test::glossy(0.3f)));
}
void add_pane(PathScene* scene) {
  const uint64_t glass = scene->material(test::glass(0.0f));
  scene->quad(Vec3(-0.5f, 0.6f, -0.5f), Vec3(0, 0, 1), Vec3(1, 0, 0), glass);
  scene->quad(Vec3(-0.5f, 0.5f, -0.5f), Vec3(1, 0, 0), Vec3(0, 0, 1), glass);
}
void add_corner(PathScene* scene) { scene->quad(Vec3(0.02f, 0, -1), Vec3(0, 0, 2), Vec3(0, 1, 0), wall(scene)); }

class Reflections : public testing::TestWithParam<Above> {
 protected:
  film::GradientImages image(uint32_t seed) const {
    PathScene scene;
    Surface light;
    light.emission = Rgb(30.0f);
    scene.quad(Vec3(-1, 0, 1), Vec3(2, 0, 0), Vec3(0, 0, -2), scene.material(GetParam().floor));
    scene.quad(Vec3(-0.8f, 1.2f, -0.1f), Vec3(0.2f, 0, 0), Vec3(0, 0, 0.2f), scene.material(light));
    GetParam().add(&scene);
    scene.camera(Vec3(-0.3f, 0.7f, 2.0f), Vec3(0, 0, 0), 0.02f);
    GradusSettings settings = test::test_settings(2, 1);
    settings.seed = seed;
    settings.max_bounces = 4;
    const integrator::IntegratorContext c = scene.context(settings);
    film::Film film = test::make_test_film(c.settings, true);
    test::sample_film(*gradient::make_gradient_integrator(c), 0, 256, &film);
    return film::read_images(film, 0);
  }
};

// Regression: an offset that missed the ball where its base met it, or met another point of it, shared nothing of the
// light that the ball reflects.
TEST_P(Reflections, B7_LightThatTheyCastOnTheFloorIsSharedByNeighbours) {
  constexpr int renders = 400;
  double sum[3] = {}, squares[3] = {};
  for (uint32_t seed = 0; seed < renders; ++seed) {
    const film::GradientImages images = image(seed);
    const double sampled = images.dx[0], of_image = double(images.primal[images.channels]) - double(images.primal[0]);
    const double values[3] = {sampled, of_image, sampled - of_image};
    for (int i = 0; i < 3; ++i) {
      sum[i] += values[i];
      squares[i] += values[i] * values[i];
    }
  }
  const auto variance = [&](int i) { return squares[i] / renders - (sum[i] / renders) * (sum[i] / renders); };
  std::printf("  variance %.4f of the image's, difference of means %.2f sigma\n", variance(0) / variance(1),
              sum[2] / renders / std::sqrt(variance(2) / renders));
  EXPECT_LT(variance(0), GetParam().maximum * variance(1));
  EXPECT_LT(std::fabs(sum[2] / renders), 4.0 * std::sqrt(variance(2) / renders));
}

INSTANTIATE_TEST_SUITE_P(
    Integrators, Reflections,
    testing::Values(Above{"MirrorBall", add_mirror_ball, test::matte(Rgb(0.8f)), 0.45f},
                    Above{"PolishedBall", add_polished_ball, test::matte(Rgb(0.8f)), 0.1f},
                    Above{"GlassBall", add_glass_ball, test::matte(Rgb(0.8f)), 0.21f},
                    Above{"Mirror", add_mirror, test::matte(Rgb(0.8f)), 0.25f},
                    Above{"MirrorOnTheFloor", add_mirror_on_the_floor, test::matte(Rgb(0.8f)), 0.3f},
                    Above{"PolishedWall", add_polished_wall, test::matte(Rgb(0.8f)), 0.014f},
                    Above{"Pane", add_pane, test::matte(Rgb(0.8f)), 0.12f},
                    Above{"Corner", add_corner, test::matte(Rgb(0.8f)), 0.6f},
                    Above{"RoughJustAboveTheThreshold", add_mirror_ball, test::glossy(0.33f), 0.3f}),
    [](const testing::TestParamInfo<Above>& info) { return std::string(info.param.name); });

// A glass ball that shows the background of a transparent film, with a held-out wall behind a part of it. `roughness`
// is that of its glass and `second` that of another glass that is mixed in; Transparent Glass ends at `limit`.
struct ClearGlass {
  const char* name;
  float roughness, second, limit;
};

class TransparentGlass : public testing::TestWithParam<ClearGlass> {
 protected:
  void SetUp() override {
    const ClearGlass& p = GetParam();
    scene_.world(Rgb(0.7f, 0.5f, 0.3f));
    scene_.quad(Vec3(-3, -0.8f, 3), Vec3(6, 0, 0), Vec3(0, 0, -6), scene_.material(test::matte(Rgb(0.6f))));
    scene_.quad(Vec3(0.1f, -0.8f, -1.5f), Vec3(1.5f, 0, 0), Vec3(0, 3, 0), scene_.material(test::matte(Rgb(0.5f))),
                GRADUS_VISIBLE_ALL | GRADUS_HOLDOUT);
    scene_.ball(Vec3(0), 0.7f, glass(p.roughness, p.second), 10, true);
    scene_.camera(Vec3(0, 0.2f, 3), Vec3(0), 0.6f);
  }
  integrator::IntegratorContext context(uint32_t seed) {
    GradusSettings settings = test::test_settings(kWidth, kHeight);
    settings.seed = seed;
    settings.max_bounces = 6;
    settings.film_transparent = settings.film_transparent_glass = 1;
    settings.film_transparent_roughness = GetParam().limit;
    return scene_.context(settings);
  }
  // Returns the mean alpha over the picture.
  double mean_alpha(const integrator::IntegratorContext& c) {
    film::Film film = test::make_test_film(c.settings, false);
    test::sample_film(*integrator::make_path_integrator(c), 0, 64, &film);
    const film::GradientImages images = film::read_images(film, 0);
    double sum = 0.0;
    for (size_t i = 3; i < images.primal.size(); i += 4) sum += images.primal[i];
    return 4.0 * sum / double(images.primal.size());
  }
  uint64_t glass(float roughness, float second) {
    test::ProgramBuilder p;
    const auto lobe = [&](float r) { return test::In::from(p.add(GRADUS_OP_GLASS, {Vec3(0.5f), r, 1.5f})); };
    const auto first = lobe(roughness), other = lobe(second);
    return scene_.material(p.desc(p.add(GRADUS_OP_ADD_SHADER, {first, other})));
  }
  PathScene scene_;
};

TEST_P(TransparentGlass, B7_GradientsAreDifferencesOfTheImage) {
  BothDirections differences;
  for (uint32_t seed = 0; seed < 24; ++seed) {
    const integrator::IntegratorContext c = context(seed);
    film::Film film = test::make_test_film(c.settings, true);
    test::sample_film(*gradient::make_gradient_integrator(c), 0, 24, &film);
    differences.add(film::read_images(film, 0));
  }
  differences.check();
}

TEST_P(TransparentGlass, AlphaBelongsToOneComponentWithEveryIntegrator) {
  integrator::IntegratorContext c = context(3);
  film::Film plain = test::make_test_film(c.settings, true);
  test::sample_film(*integrator::make_path_integrator(c), 0, 16, &plain);
  c.components = lpe::ComponentSet::parse("");
  film::Film film = test::make_test_film(c.settings, true, c.components.count());
  test::sample_film(*gradient::make_gradient_integrator(c), 0, 16, &film);
  film::Film single = test::make_test_film(c.settings, true, 1);
  integrator::IntegratorContext whole = context(3);
  test::sample_film(*gradient::make_gradient_integrator(whole), 0, 16, &single);
  const int seen = c.components.alpha_component();
  for (size_t i = 0; i < plain.components[0].primal[0].size(); ++i) {
    ASSERT_EQ(film.components[size_t(seen)].primal[0][i].w, plain.components[0].primal[0][i].w) << i;
    for (int k = 0; k < film::kOffsets; ++k) {
      for (int n = 0; n < c.components.count(); ++n) {
        const float alpha = film.components[size_t(n)].gradient[0][k][i].w;
        const float expected = n == seen ? single.components[0].gradient[0][k][i].w : 0.0f;
        ASSERT_NEAR(alpha, expected, n == seen ? 1e-4 : 0.0) << c.components[n].name << ' ' << i;
      }
    }
  }
}

TEST_P(TransparentGlass, AlphaIsLessThanWithoutTheOption) {
  const integrator::IntegratorContext c = context(1);
  GradusSettings settings = c.settings;
  settings.film_transparent_glass = 0;
  const double with = mean_alpha(c), without = mean_alpha(scene_.context(settings));
  std::printf("  alpha %.4f instead of %.4f\n", with, without);
  EXPECT_LT(with, without - 0.05);
}

INSTANTIATE_TEST_SUITE_P(Integrators, TransparentGlass,
                         testing::Values(ClearGlass{"Smooth", 0.0f, 0.0f, 0.1f},
                                         ClearGlass{"Specular", 0.2f, 0.2f, 0.3f},
                                         ClearGlass{"NonSpecular", 0.5f, 0.5f, 0.6f},
                                         ClearGlass{"OneOfTwo", 0.15f, 0.3f, 0.2f},
                                         ClearGlass{"OneOfTwoNonSpecular", 0.4f, 0.7f, 0.5f}),
                         [](const testing::TestParamInfo<ClearGlass>& info) { return std::string(info.param.name); });

std::vector<Scenario> all_scenarios() {
  std::vector<Scenario> all;
  for (int i = 0; i < static_cast<int>(Scenario::Count); ++i) all.push_back(static_cast<Scenario>(i));
  return all;
}

INSTANTIATE_TEST_SUITE_P(Integrators, Scenarios, testing::ValuesIn(all_scenarios()),
                         [](const testing::TestParamInfo<Scenario>& info) { return test::name_of(info.param); });

}  // namespace
}  // namespace gradus::gradient_test
