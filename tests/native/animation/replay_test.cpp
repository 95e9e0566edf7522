// Replays: the random numbers of one frame are used again in the next.
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "gradient/gradient_integrator.h"
#include "integrator/pixel_loop.h"
#include "motion/pixel_matching.h"
#include "support/path_scene.h"
#include "support/statistics.h"

namespace gradus::test::replay_test {
namespace {

constexpr uint32_t kSize = 40;  // more than one pixel block

GradusSettings settings_of(int32_t frame, uint32_t seed = 0) {
  GradusSettings settings = test_settings(kSize, kSize);
  settings.frame = frame;
  settings.seed = seed;
  settings.independent_sampler = 0;
  return settings;
}

const Region kWhole{0, 0, int32_t(kSize), int32_t(kSize)};

film::Film sampled(const integrator::IntegratorContext& context, uint32_t samples,
                   const film::ReplayMap* replay_map = nullptr, const Region& region = kWhole) {
  film::Film frame(kSize, kSize, region, 3, 1, true);
  integrator::WorkUnit unit;
  unit.tile = frame.region;
  unit.count = samples;
  unit.replay_map = replay_map;
  gradient::make_gradient_integrator(context)->sample(unit, &frame, &frame.counters, std::atomic<bool>{false});
  return frame;
}

film::ReplayMap sources_of(const integrator::IntegratorContext& before, const integrator::IntegratorContext& now,
                           const Region& region = kWhole) {
  const film::PixelCorrespondence correspondence =
      motion::match_pixels(motion::view_centres(*before.snapshot, kSize, kSize, region),
                           motion::view_centres(*now.snapshot, kSize, kSize, region));
  return {before.settings.frame, motion::inverse_correspondence(correspondence), 0, before.settings.seed};
}

class Replays : public testing::TestWithParam<Scenario> {};

TEST_P(Replays, OfAStillSceneHaveTheBitsOfTheFrameBefore) {
  PathScene scene;
  build(GetParam(), &scene);
  const integrator::IntegratorContext before = scene.context(settings_of(7)), now = scene.context(settings_of(8));
  const film::ReplayMap replay_map = sources_of(before, now);
  const film::Film base = sampled(before, 4), offset = sampled(now, 4, &replay_map), own = sampled(now, 4);
  for (int half = 0; half < film::kHalves; ++half) {
    EXPECT_EQ(base.components[0].primal[half], offset.components[0].primal[half]);
    for (int k = 0; k < film::kOffsets; ++k)
      EXPECT_EQ(base.components[0].gradient[half][k], offset.components[0].gradient[half][k]);
    EXPECT_NE(base.components[0].primal[half], own.components[0].primal[half]);
  }
}

INSTANTIATE_TEST_SUITE_P(All, Replays,
                         testing::Values(Scenario::DiffuseArea, Scenario::Glass, Scenario::Transparent,
                                         Scenario::World),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// Shutter times and lens positions are random numbers like others.
TEST(Replay, SeesWhatWasSeenAtItsTimesThroughTheLens) {
  PathScene scene;
  build(Scenario::Moving, &scene);
  scene.camera_desc.aperture_radius = 0.1f;
  const integrator::IntegratorContext before = scene.context(settings_of(7)), now = scene.context(settings_of(8));
  film::ReplayMap replay_map{7, {std::vector<int32_t>(size_t(kSize) * kSize)}, 0, 0, false};
  std::iota(replay_map.correspondence.pixel.begin(), replay_map.correspondence.pixel.end(), 0);
  const film::Film base = sampled(before, 4), offset = sampled(now, 4, &replay_map);
  for (int half = 0; half < film::kHalves; ++half)
    EXPECT_TRUE(base.components[0].primal[half] == offset.components[0].primal[half]);
}

// Pixels of a region are counted from its corner, but their random numbers from that of the film.
TEST(Replay, OfABorderUsesTheNumbersOfItsOwnPixels) {
  PathScene scene;
  build(Scenario::DiffuseArea, &scene);
  const integrator::IntegratorContext before = scene.context(settings_of(7)), now = scene.context(settings_of(8));
  const Region border{9, 5, 31, 22};
  film::ReplayMap replay_map = sources_of(before, now, border);
  const film::Film base = sampled(before, 4, nullptr, border), offset = sampled(now, 4, &replay_map, border);
  for (int half = 0; half < film::kHalves; ++half)
    EXPECT_EQ(base.components[0].primal[half], offset.components[0].primal[half]);
}

// Disoccluded pixels have no correspondence. Both halves of their frame sample them with different random numbers,
// because repeated ones would add no information.
TEST(Replay, DisocclusionsHaveRandomNumbersOfTheirOwn) {
  PathScene scene;
  build(Scenario::DiffuseArea, &scene);
  const integrator::IntegratorContext now = scene.context(settings_of(8));
  const film::ReplayMap no_correspondence{7, {std::vector<int32_t>(size_t(kSize) * kSize, film::kNoCorrespondence)}};
  const film::Film own = sampled(now, 4), offset = sampled(now, 4, &no_correspondence);
  size_t lit = 0, alike = 0;
  for (size_t i = 0; i < no_correspondence.correspondence.pixel.size(); ++i) {
    const Radiance &a = own.components[0].primal[0][i], &b = offset.components[0].primal[0][i];
    lit += a.x > 0.0f;
    alike += a.x > 0.0f && a == b;
  }
  EXPECT_GT(lit, no_correspondence.correspondence.pixel.size() / 2);
  EXPECT_LT(alike, lit / 10);  // the light itself
}

// A camera that moves sideways by 5.3 pixels.
struct Pan {
  explicit Pan(Scenario scenario) {
    build(scenario, &scene);
    before_desc = scene.camera_desc;
    scene.camera(Vec3(0.12f, 0, 3.2f), Vec3(0.12f, 0, 0), 0.9f);
    now_desc = scene.camera_desc;
  }
  integrator::IntegratorContext context(bool now, uint32_t seed) {
    scene.camera_desc = now ? now_desc : before_desc;
    return scene.context(settings_of(now ? 2 : 1, seed));
  }
  PathScene scene;
  GradusCamera before_desc{}, now_desc{};
};

float gray(const film::Film& frame, size_t pixel) {
  Radiance sum = frame.components[0].primal[0][pixel] + frame.components[0].primal[1][pixel];
  const uint32_t count = film::samples_at(frame, pixel);
  return (sum.x + sum.y + sum.z) / (3.0f * float(count));
}

// The replayed half is a picture of its own frame, whatever it replays: the means over seeds agree.
TEST(Replay, IsAPictureOfItsOwnFrame) {
  Pan pan(Scenario::DiffuseArea);
  Moments replayed, fresh;
  int uncorresponded = 0;
  for (uint32_t seed = 0; seed < 48; ++seed) {
    const integrator::IntegratorContext before = pan.context(false, seed), now = pan.context(true, seed);
    const film::ReplayMap replay_map = sources_of(before, now);
    const film::Film offset = sampled(now, 8, &replay_map), other = sampled(now, 8);
    std::vector<float> a(offset.count[0].size()), b(a.size());
    for (size_t i = 0; i < a.size(); ++i) a[i] = gray(offset, i), b[i] = gray(other, i);
    replayed.add(a);
    fresh.add(b);
    for (const int32_t source : replay_map.correspondence.pixel) uncorresponded += source == film::kNoCorrespondence;
  }
  EXPECT_GT(uncorresponded, 48 * 2 * int(kSize)) << "the strip that comes into view";
  double mean_a = 0.0, mean_b = 0.0, variance = 0.0;
  for (size_t i = 0; i < replayed.size(); ++i) {
    mean_a += replayed.mean(i);
    mean_b += fresh.mean(i);
    variance += replayed.variance_of_mean(i) + fresh.variance_of_mean(i);
  }
  // The pixels of a block share their jitter: neighbours are correlated, at most as if the 256 pixels of a block were
  // one.
  EXPECT_LT(std::fabs(mean_a - mean_b), 4.0 * std::sqrt(variance * 16.0));
  EXPECT_NEAR(mean_a / mean_b, 1.0, 0.02);
}

// The purpose of replays: differences over time between corresponding pixels have less noise than those of independent
// samples.
TEST(Replay, ReducesTheNoiseOfDifferencesOverTime) {
  for (const Scenario scenario : {Scenario::DiffuseArea, Scenario::World}) {
    Pan pan(scenario);
    double linked = 0.0, independent = 0.0;
    for (uint32_t seed = 0; seed < 6; ++seed) {
      const integrator::IntegratorContext before = pan.context(false, seed), now = pan.context(true, seed);
      const film::ReplayMap replay_map = sources_of(before, now);
      const film::Film base = sampled(before, 4), offset = sampled(now, 4, &replay_map), other = sampled(now, 4);
      for (size_t q = 0; q < replay_map.correspondence.pixel.size(); ++q) {
        const int32_t i = replay_map.correspondence.pixel[q];
        if (i == film::kNoCorrespondence) continue;
        linked += std::pow(gray(offset, q) - gray(base, size_t(i)), 2);
        independent += std::pow(gray(other, q) - gray(base, size_t(i)), 2);
      }
    }
    EXPECT_LT(linked, 0.6 * independent) << name_of(scenario);
    std::printf("  %s: energy of differences over time %.2f of independent samples'\n", name_of(scenario),
                linked / independent);
  }
}

}  // namespace
}  // namespace gradus::test::replay_test
