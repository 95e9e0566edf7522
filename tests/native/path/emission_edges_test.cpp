// Further camera rays at the edges of emitters: where they are taken, and that they change noise alone.
#include "path/emission_edges.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include <gtest/gtest.h>

#include "output/pass_read.h"
#include "render/scene_render.h"
#include "schema/pass_table.h"
#include "support/light_sum.h"

namespace gradus::emission_edges_test {
namespace {

constexpr uint32_t kWidth = 32, kHeight = 24;
constexpr float kEmission = 5.0f;
// The film shows 2.7 m of the plane of the window, whose right edge leans.
constexpr float kShown = 2.7f, kEdgeAtMiddle = 0.1f, kLean = 0.1f;

test::Surface emitter(float emission) {
  test::Surface surface;
  surface.emission = Rgb(emission);
  return surface;
}

void add_window(test::PathScene* scene) {
  scene->camera(Vec3(0, 0, 3), Vec3(0, 0, 0), 0.9f);
  scene->quad(Vec3(-2.0f, -2.0f, 0.0f), Vec3(2.0f + kEdgeAtMiddle - 2.0f * kLean, 0, 0), Vec3(4.0f * kLean, 4, 0),
              scene->material(emitter(kEmission)));
}

// A window before a wall.
void add_room(test::PathScene* scene, const test::Surface& wall = test::matte(Rgb(0.5f))) {
  add_window(scene);
  scene->quad(Vec3(-4, -4, -1), Vec3(8, 0, 0), Vec3(0, 8, 0), scene->material(wall));
}

struct Sampling {
  explicit Sampling(const std::function<void(test::PathScene*)>& build, bool transparent = false)
      : settings(test::test_settings(kWidth, kHeight)) {
    settings.film_transparent = transparent ? 1 : 0;
    settings.passes = kPasses;
    build(&scene);
    context = scene.context(settings);
  }

  std::vector<uint8_t> edges(const Region& region) const {
    const path::PathContext path(*context.snapshot, context.camera, context.settings);
    return path::find_emission_edges(path, region, std::atomic<bool>{false});
  }
  std::vector<uint8_t> edges() const { return edges(kAll); }

  // Samples a film, with further rays at edges or without.
  film::Film sampled(uint32_t samples, bool further) const {
    film::Film film = test::make_test_film(settings, false);
    film.settings = settings;
    film::add_pass_channels(settings.passes, &film);
    const std::vector<uint8_t> map = edges();
    integrator::WorkUnit unit{kAll, 0, samples};
    if (further) unit.edge_map = &map;
    integrator::make_path_integrator(context)->sample(unit, &film, &film.counters, std::atomic<bool>{false});
    return film;
  }

  static constexpr Region kAll{0, 0, kWidth, kHeight};
  static constexpr uint64_t kPasses = (uint64_t{1} << GRADUS_PASS_COUNT) - 1;
  test::PathScene scene;
  GradusSettings settings;
  integrator::IntegratorContext context;
};

std::vector<float> read(const film::Film& film, uint32_t pass) {
  std::vector<float> pixels(size_t(film.region.area()) * schema::pass_info(pass).channels);
  output::read_film_pass(film, pass, film.region, pixels.data());
  return pixels;
}

// Mean of a plane over pixels at edges, and the variance of that mean by the halves.
struct Mean {
  double value = 0.0, variance = 0.0;
};

template <class ValueOf>
Mean mean_at(const std::vector<uint8_t>& edges, const film::Film& film, const ValueOf& value_of) {
  Mean mean;
  double pixels = 0.0;
  for (size_t i = 0; i < edges.size(); ++i) {
    if (edges[i] == 0) continue;
    const double a = value_of(0, i) / film.count[0][i], b = value_of(1, i) / film.count[1][i];
    mean.value += 0.5 * (a + b);
    mean.variance += 0.25 * (a - b) * (a - b);
    pixels += 1.0;
  }
  return {mean.value / pixels, mean.variance / (pixels * pixels)};
}

Mean light_at(const std::vector<uint8_t>& edges, const film::Film& film) {
  return mean_at(edges, film, [&](int half, size_t i) { return film.components[0].primal[half][i].y; });
}

void expect_equal(const Mean& a, const Mean& b, const std::string& name) {
  EXPECT_NEAR(a.value, b.value, 5.0 * std::sqrt(a.variance + b.variance) + 1e-4 * std::fabs(a.value)) << name;
}

TEST(EmissionEdges, AreThePixelsAroundTheOutlineOfAnEmitter) {
  const std::vector<uint8_t> edges = Sampling([](auto* scene) { add_room(scene); }).edges();
  ASSERT_EQ(edges.size(), size_t(kWidth * kHeight));
  for (uint32_t y = 0; y < kHeight; ++y) {
    const float metres = kShown / kWidth, up = (float(y) + 0.5f - kHeight / 2.0f) * metres,
                column = (kEdgeAtMiddle + kLean * up) / metres + kWidth / 2.0f;
    for (uint32_t x = 0; x < kWidth; ++x) {
      const float distance = std::fabs(float(x) + 0.5f - column);
      if (distance >= 0.5f && distance <= 2.0f) continue;
      EXPECT_EQ(edges[y * kWidth + x], distance < 0.5f ? 1 : 0) << x << " " << y;
    }
  }
}

TEST(EmissionEdges, DoNotDependOnTheRegion) {
  const Sampling room([](auto* scene) { add_room(scene); });
  const std::vector<uint8_t> all = room.edges();
  const Region part{9, 5, 23, 17};
  const std::vector<uint8_t> edges = room.edges(part);
  for (int y = part.y0; y < part.y1; ++y) {
    for (int x = part.x0; x < part.x1; ++x)
      EXPECT_EQ(edges[size_t((y - part.y0) * part.width() + x - part.x0)], all[size_t(y) * kWidth + size_t(x)]);
  }
}

TEST(EmissionEdges, AreMissingWhereNothingEmits) {
  EXPECT_TRUE(Sampling([](auto* scene) { test::add_box(scene, test::matte(Rgb(0.5f))); }).edges().empty());
}

// Two emitters side by side that are as bright as each other.
TEST(EmissionEdges, NeedContrast) {
  const std::vector<uint8_t> edges = Sampling([](auto* scene) { add_room(scene, emitter(0.9f * kEmission)); }).edges();
  EXPECT_EQ(std::accumulate(edges.begin(), edges.end(), 0), 0);
}

// Regression: beside a wall that is nearly as bright as the sky, further rays had 76 times the variance.
TEST(EmissionEdges, AreNoneBesideSurfacesAsBright) {
  const Sampling wall([](auto* scene) {
    scene->world(Rgb(1.0f));
    scene->camera(Vec3(0, 0, 3), Vec3(0, 0, 0), 0.9f);
    scene->quad(Vec3(-1, -1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), scene->material(test::matte(Rgb(0.9f))));
  });
  const std::vector<uint8_t> edges = wall.edges();
  ASSERT_EQ(edges.size(), size_t(kWidth * kHeight));
  EXPECT_EQ(std::accumulate(edges.begin(), edges.end(), 0), 0);
}

// Analytic lights and the sky have outlines, too.
TEST(EmissionEdges, AreThoseOfLightsAndOfTheSky) {
  const Sampling seen([](auto* scene) { test::build(test::Scenario::LightsSeen, scene); });
  const Sampling sky([](auto* scene) {
    scene->world(Rgb(1.0f));
    scene->camera(Vec3(0, 0, 3), Vec3(0, 0, 0), 0.9f);
    scene->quad(Vec3(-1, -1, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), scene->material(test::matte(Rgb(0.1f))));
  });
  for (const Sampling* sampling : {&seen, &sky}) {
    const std::vector<uint8_t> edges = sampling->edges();
    EXPECT_GT(std::accumulate(edges.begin(), edges.end(), 0), 4);
    EXPECT_LT(std::accumulate(edges.begin(), edges.end(), 0), int(edges.size()) / 3);
  }
}

TEST(EmissionEdges, FurtherRaysKeepTheMean) {
  const Sampling room([](auto* scene) { add_room(scene); });
  const std::vector<uint8_t> edges = room.edges();
  expect_equal(light_at(edges, room.sampled(256, false)), light_at(edges, room.sampled(256, true)), "light");
}

TEST(EmissionEdges, FurtherRaysLessenTheNoiseOfWhatTheCameraSees) {
  const Sampling window(add_window);
  const std::vector<uint8_t> edges = window.edges();
  const Mean before = light_at(edges, window.sampled(64, false)), after = light_at(edges, window.sampled(64, true));
  EXPECT_LT(after.variance, before.variance / 8.0);
}

// Beside a mirror features are those of the path, unless no further ray meets it.
TEST(EmissionEdges, FurtherRaysKeepTheMeansOfFeatures) {
  test::Surface mirror;
  mirror.glossy = Rgb(0.8f);
  for (const test::Surface& wall : {test::matte(Rgb(0.5f)), mirror}) {
    const Sampling room([&](auto* scene) { add_room(scene, wall); });
    const film::Film usual = room.sampled(256, false), further = room.sampled(256, true);
    const std::vector<uint8_t> edges = room.edges();
    for (const uint32_t pass :
         {GRADUS_PASS_DENOISING_ALBEDO, GRADUS_PASS_DENOISING_NORMAL, GRADUS_PASS_DENOISING_DEPTH}) {
      const uint32_t channels = schema::pass_info(pass).channels, last = channels - 1;
      const auto mean = [&](const film::Film& film) {
        const film::Channel* plane = film.channels.of_pass(pass);
        return mean_at(edges, film, [&](int half, size_t i) { return plane->values[half][channels * i + last]; });
      };
      EXPECT_NEAR(mean(further).value, mean(usual).value, 0.03 * std::fabs(mean(usual).value))
          << schema::pass_info(pass).name;
    }
  }
}

TEST(EmissionEdges, LightPassesAddUpToTheNoisyImage) {
  const film::Film film = Sampling([](auto* scene) { add_room(scene); }).sampled(8, true);
  test::expect_light_to_add_up([&](uint32_t pass) { return read(film, pass); }, read(film, GRADUS_PASS_NOISY_IMAGE));
}

// Data passes show what paths meet.
TEST(EmissionEdges, DataPassesKeepTheirBits) {
  const Sampling room([](auto* scene) { add_room(scene); });
  const film::Film usual = room.sampled(8, false), further = room.sampled(8, true);
  for (const uint32_t pass : {GRADUS_PASS_DEPTH, GRADUS_PASS_NORMAL, GRADUS_PASS_MIST, GRADUS_PASS_DIFFUSE_COLOR})
    EXPECT_EQ(read(usual, pass), read(further, pass)) << schema::pass_info(pass).name;
}

// Light and alpha of an emitter come from the same rays.
TEST(EmissionEdges, TransparentFilmsStayPremultiplied) {
  const film::Film film = Sampling(add_window, true).sampled(8, true);
  float partly = 0.0f;
  for (size_t i = 0; i < size_t(film.region.area()); ++i) {
    const Radiance sum = film.components[0].primal[0][i];
    EXPECT_NEAR(sum.x, kEmission * sum.w, 1e-4f * kEmission);
    partly += sum.w > 0.1f && sum.w < 3.9f ? 1.0f : 0.0f;
  }
  EXPECT_GT(partly, 10.0f);
}

TEST(EmissionEdges, AreUsedByRendersWithoutGradients) {
  for (const uint32_t integrator : {GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT}) {
    test::PathScene scene;
    add_room(&scene);
    GradusSettings settings = test::test_settings(kWidth, kHeight);
    settings.integrator = integrator;
    settings.samples = 2;
    settings.max_bounces = 0;
    const auto film = test::rendered(&scene, settings)->film();
    const uint64_t own = uint64_t(film->region.area()) * settings.samples;
    EXPECT_EQ(film->counters.rays_primary > own + 500, integrator == GRADUS_INTEGRATOR_PATH);
  }
}

}  // namespace
}  // namespace gradus::emission_edges_test
