// Path guiding in a render: when it is used, what it gains, and that it keeps bits, regions, resume and cancel.
#include "render/guiding.h"

#include <cmath>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "render/fake_integrator.h"
#include "render/scene_render.h"
#include "schema/options.h"
#include "support/statistics.h"

namespace gradus::guiding_test {
namespace {

using FilmPointer = std::shared_ptr<const film::Film>;

constexpr uint32_t kWidth = 80, kHeight = 60, kSamples = 32;
constexpr Region kFrame{0, 0, int32_t(kWidth), int32_t(kHeight)};

GradusSettings make_settings(uint32_t width = kWidth, uint32_t height = kHeight, uint32_t samples = kSamples) {
  GradusSettings s = schema::default_settings();
  s.width = width;
  s.height = height;
  s.samples = samples;
  s.use_guiding = 1;
  s.threads = 2;
  s.noise_threshold = 0.0f;
  s.denoiser = GRADUS_DENOISER_NONE;
  s.integrator = GRADUS_INTEGRATOR_PATH;
  s.reconstruction = GRADUS_RECONSTRUCTION_NONE;
  return s;
}

struct Paths {
  uint32_t count = 0;
  std::string why_not;
};

Paths paths_of(const GradusSettings& settings, uint32_t samples, const Region& region) {
  Paths paths;
  paths.count = render::guide_paths(settings, samples, region, &paths.why_not);
  EXPECT_EQ(paths.count == 0, !paths.why_not.empty());
  return paths;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(GuidePaths, AreAShareOfTheSamples) {
  const Region frame{0, 0, 400, 300};
  const GradusSettings s = make_settings(400, 300);
  EXPECT_EQ(paths_of(s, 16, frame).count, 120000u);
  EXPECT_EQ(paths_of(s, 8, frame).count, 60000u);
  EXPECT_EQ(paths_of(s, 4096, frame).count, paths_of(s, 1024, frame).count) << "at most so many";
  EXPECT_LE(paths_of(s, 4096, frame).count, 1000000u);
  EXPECT_EQ(paths_of(s, 16, {0, 0, 400, 150}).count, 120000u) << "a part of the frame has the guide of the frame";
}

TEST(GuidePaths, AreLimitedByTheTime) {
  GradusSettings s = make_settings(400, 300);
  s.time_limit = 2.0f;
  EXPECT_EQ(paths_of(s, 1024, {0, 0, 400, 300}).count, 40000u);
  s.time_limit = 0.1f;
  EXPECT_TRUE(contains(paths_of(s, 1024, {0, 0, 400, 300}).why_not, "too few samples"));
}

TEST(GuidePaths, SayWhyThereAreNone) {
  GradusSettings s = make_settings(400, 300);
  const Region frame{0, 0, 400, 300};
  EXPECT_TRUE(contains(paths_of(s, 1, frame).why_not, "too few samples"));
  EXPECT_TRUE(contains(paths_of(s, 64, {0, 0, 400, 149}).why_not, "small part of the frame"));
  EXPECT_GT(paths_of(s, 64, {0, 0, 400, 150}).count, 0u) << "half is enough";
  s.max_bounces = 0;
  EXPECT_TRUE(contains(paths_of(s, 64, frame).why_not, "do not bounce"));
  s.max_bounces = 1;
  EXPECT_GT(paths_of(s, 64, frame).count, 0u);
  s.use_guiding = 0;
  EXPECT_TRUE(contains(paths_of(s, 64, frame).why_not, "use_guiding"));
  std::string why_not = "another reason";
  EXPECT_EQ(render::guide_paths(make_settings(400, 300), 64, frame, &why_not), 0u);
  EXPECT_EQ(why_not, "another reason");
}

// Builds a closed room whose light comes over a wall.
void build_gap(test::PathScene* scene) {
  test::add_box(scene, test::matte(Rgb(0.6f)));
  const uint64_t white = scene->material(test::matte(Rgb(0.8f)));
  test::Surface light;
  light.emission = Rgb(60.0f);
  scene->quad(Vec3(0.3f, -1, -1), Vec3(0, 0, 2), Vec3(0, 1.7f, 0), white);
  scene->quad(Vec3(-1, -1, 1), Vec3(0, 2, 0), Vec3(2, 0, 0), white);
  scene->quad(Vec3(0.5f, -0.9f, -0.2f), Vec3(0, 0, 0.4f), Vec3(0.3f, 0, 0), scene->material(light));
  scene->camera(Vec3(-0.3f, 0, 0.95f), Vec3(-0.4f, 0, -1), 1.6f);
}

std::unique_ptr<render::Render> render_gap(const GradusSettings& settings, const FilmPointer& resumed = nullptr) {
  test::PathScene scene;
  build_gap(&scene);
  auto render =
      std::make_unique<render::Render>(test::test_device(), scene.context(settings).snapshot, settings, resumed);
  render->wait(-1.0);
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_OK) << text;
  return render;
}

nlohmann::json plan_of(const render::Render& render) { return nlohmann::json::parse(render.stats_json())["plan"]; }

std::vector<float> image_of(const film::Film& film) { return film::read_images(film, 0).primal; }

struct Noise {
  double absolute = 0.0, squared = 0.0;  // sums of the differences of two seeds
};

Noise noise_of(const std::vector<float>& a, const std::vector<float>& b) {
  Noise noise;
  for (size_t i = 0; i < a.size(); ++i) {
    noise.absolute += std::fabs(double(a[i]) - b[i]);
    noise.squared += std::pow(double(a[i]) - b[i], 2);
  }
  return noise;
}

// The noise is the mean absolute difference, since few bright paths have most of the squares.
TEST(GuidedRender, HasTheSameMeanAndLessNoise) {
  std::vector<float> images[2][2];
  for (uint32_t seed = 0; seed < 2; ++seed) {
    for (uint32_t guided = 0; guided < 2; ++guided) {
      GradusSettings s = make_settings();
      s.seed = seed;
      s.use_guiding = guided;
      const auto render = render_gap(s);
      const nlohmann::json plan = plan_of(*render);
      EXPECT_EQ(plan["chosen"].contains("path guiding"), guided == 1) << plan;
      EXPECT_EQ(plan["skipped"].contains("path guiding"), guided == 0) << plan;
      images[guided][seed] = image_of(*render->film());
    }
  }
  const Noise plain = noise_of(images[0][0], images[0][1]), guided = noise_of(images[1][0], images[1][1]);
  std::printf("  noise with the guide over that without: %.2f (squares %.2f)\n", guided.absolute / plain.absolute,
              guided.squared / plain.squared);
  EXPECT_LT(guided.absolute, 0.9 * plain.absolute);
  const auto mean_of = [&](int i) { return 0.5 * (test::mean(images[i][0]) + test::mean(images[i][1])); };
  // The channels of a pixel come from the same paths.
  const double deviation = std::sqrt((plain.squared + guided.squared) / 4.0 * 3.0) / double(images[0][0].size());
  EXPECT_NEAR(mean_of(1), mean_of(0), 5.0 * deviation);
}

TEST(GuidedRender, SaysWhyItIsNotGuided) {
  GradusSettings s = make_settings();
  s.use_guiding = 0;
  EXPECT_TRUE(contains(plan_of(*render_gap(s))["skipped"]["path guiding"], "use_guiding"));
  // Light from everywhere gives no reason.
  test::PathScene scene;
  scene.quad(Vec3(-5, 0, 5), Vec3(10, 0, 0), Vec3(0, 0, -10), scene.material(test::matte(Rgb(0.5f))));
  scene.world(Rgb(1.0f));
  scene.camera(Vec3(0, 2, 0), Vec3(0), 2.0f);
  EXPECT_TRUE(contains(plan_of(*test::rendered(&scene, make_settings()))["skipped"]["path guiding"], "only 0 %"));
}

TEST(GuidedRender, HasTheSameBitsForAnyNumberOfThreads) {
  for (const uint32_t integrator : {GRADUS_INTEGRATOR_PATH, GRADUS_INTEGRATOR_GRADIENT}) {
    FilmPointer first;
    for (const uint32_t threads : {1u, 2u}) {
      GradusSettings s = make_settings(kWidth, kHeight, 28);
      s.integrator = integrator;
      s.threads = threads;
      const auto render = render_gap(s);
      EXPECT_TRUE(plan_of(*render)["chosen"].contains("path guiding"));
      if (!first) first = render->film();
      EXPECT_TRUE(test::same_samples(*render->film(), *first)) << integrator;
    }
  }
}

TEST(GuidedRender, ResumeHasTheBitsOfOneRender) {
  GradusSettings part = make_settings();
  part.samples = 8;
  part.net_samples = kSamples;
  const auto first = render_gap(part);
  EXPECT_TRUE(plan_of(*first)["chosen"].contains("path guiding"));
  const auto whole = render_gap(make_settings()), resumed = render_gap(make_settings(), first->film());
  EXPECT_TRUE(test::same_samples(*whole->film(), *resumed->film()));
}

// The samples of guided and other paths are not mixed unnoticed.
TEST(GuidedRender, ResumeRefusesAnotherSetting) {
  GradusSettings part = make_settings(), other = make_settings();
  part.samples = 8;
  other.use_guiding = 0;
  EXPECT_THROW(render_gap(other, render_gap(part)->film()), std::exception);
}

TEST(GuidedRender, ARegionHasThePixelsOfTheFrame) {
  const auto whole = render_gap(make_settings());
  GradusSettings s = make_settings();
  const Region region{10, 5, 70, 55};
  const int32_t corners[] = {region.x0, region.y0, region.x1, region.y1};
  std::copy(corners, corners + 4, s.region);
  const auto part = render_gap(s);
  EXPECT_TRUE(plan_of(*part)["chosen"].contains("path guiding"));
  const std::vector<float> all = test::read(*whole, GRADUS_PASS_NOISY_IMAGE, kFrame),
                           some = test::read(*part, GRADUS_PASS_NOISY_IMAGE, region);
  const size_t channels = some.size() / size_t(region.area());
  for (int32_t y = region.y0; y < region.y1; ++y) {
    for (int32_t x = region.x0; x < region.x1; ++x) {
      for (size_t c = 0; c < channels; ++c)
        ASSERT_EQ(some[region.index(x, y) * channels + c], all[kFrame.index(x, y) * channels + c]) << x << ' ' << y;
    }
  }
}

// The training of a million paths takes seconds.
TEST(GuidedRender, ACancelDuringTheTrainingIsACancel) {
  test::PathScene scene;
  build_gap(&scene);
  const auto render = test::started(&scene, make_settings(1000, 1000, 64));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_FALSE(render->wait(0.0));
  render->cancel();
  EXPECT_TRUE(render->wait(5.0));
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_ERROR_CANCELLED) << text;
  const std::vector<float> image = test::read(*render, GRADUS_PASS_COMBINED, {0, 0, 1000, 1000});
  EXPECT_TRUE(std::all_of(image.begin(), image.end(), [](float v) { return v == 0.0f; })) << "no sample was taken";
}

}  // namespace
}  // namespace gradus::guiding_test
