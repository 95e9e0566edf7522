// Further samples at edges: where they are taken, and what they depend on.
#include "render/edge_sampling.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "render/batches.h"
#include "render/fake_integrator.h"
#include "render/resume.h"
#include "render/scene_render.h"
#include "schema/options.h"

namespace gradus::edge_sampling_test {
namespace {

constexpr int kWidth = 48, kHeight = 8;
constexpr uint32_t kUsual = 4;

struct Side {
  float albedo, light;
};

constexpr Side kDark{0.2f, 0.1f}, kBright{0.8f, 1.0f};

// A film with two samples of each pixel in either half.
template <class SideOf>
film::Film film_of(const SideOf& side_of) {
  film::Film film(kWidth, kHeight, {0, 0, kWidth, kHeight}, 3, 1, false);
  film.settings = schema::default_settings();
  film::add_pass_channels((uint64_t{1} << GRADUS_PASS_DENOISING_ALBEDO) |
                              (uint64_t{1} << GRADUS_PASS_DENOISING_NORMAL) |
                              (uint64_t{1} << GRADUS_PASS_DENOISING_DEPTH),
                          &film);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    const Side side = side_of(i % kWidth, i / kWidth);
    for (int half = 0; half < film::kHalves; ++half) {
      film.count[half][size_t(i)] = 2;
      film.components[0].primal[half][size_t(i)] = Radiance(Rgb(2.0f * side.light), 0.0f);
      float* albedo = film.channels.of_pass(GRADUS_PASS_DENOISING_ALBEDO)->values[half].data() + 3 * i;
      std::fill_n(albedo, 3, 2.0f * side.albedo);
    }
  }
  return film;
}

film::Film two_sides() {
  return film_of([](int x, int) { return x < kWidth / 2 ? kDark : kBright; });
}

uint32_t at(const std::vector<uint32_t>& counts, int x, int y) { return counts[size_t(y * kWidth + x)]; }

TEST(EdgeSampling, TakesFurtherSamplesOnBothSidesOfAnEdge) {
  const std::vector<uint32_t> counts = render::further_samples_at_edges(two_sides(), kUsual);
  ASSERT_EQ(counts.size(), size_t(kWidth * kHeight));
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool is_beside = x == kWidth / 2 - 1 || x == kWidth / 2;
      EXPECT_EQ(at(counts, x, y) > 0, is_beside) << x << " " << y;
      EXPECT_EQ(at(counts, x, y) % 2, 0u);
      EXPECT_LE(at(counts, x, y), kUsual * render::kMaxFactorAtEdges);
    }
  }
}

// A regression joins pixels of equal features, and of different features in equal light it finds what little differs.
TEST(EdgeSampling, NeedsAnEdgeInFeaturesAndInLight) {
  EXPECT_TRUE(render::further_samples_at_edges(film_of([](int, int) { return kBright; }), kUsual).empty());
  const auto same_light = film_of([](int x, int) { return x < kWidth / 2 ? Side{0.2f, 1.0f} : Side{0.8f, 1.0f}; });
  EXPECT_TRUE(render::further_samples_at_edges(same_light, kUsual).empty());
  const auto same_features = film_of([](int x, int) { return x < kWidth / 2 ? Side{0.5f, 0.1f} : Side{0.5f, 1.0f}; });
  EXPECT_TRUE(render::further_samples_at_edges(same_features, kUsual).empty());
}

// Else a pixel that is bright by chance would get more samples, and the mean of its samples would be too low.
TEST(EdgeSampling, DoesNotDependOnThePixelsOwnSamples) {
  const film::Film film = two_sides();
  const std::vector<uint32_t> counts = render::further_samples_at_edges(film, kUsual);
  for (const auto& [x, y] : {std::pair(kWidth / 2, 3), std::pair(kWidth / 2 - 2, 4), std::pair(0, 0)}) {
    film::Film changed = film;
    changed.components[0].primal[0][size_t(y * kWidth + x)] = Radiance(1e7f);
    changed.channels.of_pass(GRADUS_PASS_DENOISING_ALBEDO)->values[1][size_t(3 * (y * kWidth + x))] = 2.0f;
    EXPECT_EQ(at(render::further_samples_at_edges(changed, kUsual), x, y), at(counts, x, y)) << x << " " << y;
  }
}

TEST(EdgeSampling, TakesHalfOfTheUsualSamplesAtMost) {
  const auto film = film_of([](int x, int y) { return (x / 2 + y / 2) % 2 == 0 ? kDark : kBright; });
  const std::vector<uint32_t> counts = render::further_samples_at_edges(film, 16);
  const double mean = double(std::accumulate(counts.begin(), counts.end(), 0u)) / double(counts.size());
  EXPECT_LE(mean, 8.0);
  EXPECT_GT(mean, 6.0);
}

// What a factor on the light leaves as it is shown.
TEST(EdgeSampling, FollowsTheExposure) {
  film::Film dark = film_of([](int x, int) { return x < kWidth / 2 ? Side{0.2f, 1e-4f} : Side{0.8f, 1e-3f}; });
  EXPECT_TRUE(render::further_samples_at_edges(dark, kUsual).empty());
  dark.settings.film_exposure = 1e3f;
  EXPECT_EQ(render::further_samples_at_edges(dark, kUsual), render::further_samples_at_edges(two_sides(), kUsual));
}

class EdgesOfARender : public testing::Test {
 protected:
  EdgesOfARender() {
    test::add_box(&scene_, test::matte(Rgb(0.5f)));
    test::add_ceiling_light(&scene_, 8.0f, 0.6f);
    settings_.width = 48;
    settings_.height = 36;
    settings_.integrator = GRADUS_INTEGRATOR_PATH;
    settings_.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
    settings_.denoiser = GRADUS_DENOISER_NONE;
    settings_.net_samples = 64;  // of films that are resumed and of whole ones
    settings_.noise_threshold = 0.0f;
  }

  std::shared_ptr<const film::Film> sampled(uint32_t samples,
                                            const std::shared_ptr<const film::Film>& resumed = nullptr) {
    settings_.samples = samples;
    if (!snapshot_) snapshot_ = scene_.context(settings_).snapshot;
    render::Render render(test::test_device(), snapshot_, settings_, resumed);
    render.wait(-1.0);
    std::string text;
    EXPECT_EQ(render.outcome(&text), GRADUS_OK) << text;
    return render.film();
  }

  test::PathScene scene_;
  GradusSettings settings_ = schema::default_settings();
  std::shared_ptr<const scene::Snapshot> snapshot_;
};

std::pair<uint32_t, uint32_t> range_of_counts(const film::Film& film) {
  const std::vector<uint32_t> counts = film::samples_of_pixels(film);
  const auto [low, high] = std::minmax_element(counts.begin(), counts.end());
  return {*low, *high};
}

TEST_F(EdgesOfARender, HaveMoreSamplesFromFourOn) {
  EXPECT_EQ(range_of_counts(*sampled(2)), std::pair(2u, 2u));
  const auto [low, high] = range_of_counts(*sampled(4));
  EXPECT_EQ(low, 4u);
  EXPECT_GE(high, 8u);
}

// Further samples belong to whole batches, whether a render ended there or not.
TEST_F(EdgesOfARender, AreSampledAsInOneRenderAfterResuming) {
  const auto whole = sampled(32);
  for (const uint32_t first : {4u, 6u, 16u, 20u})
    EXPECT_TRUE(test::same_samples(*sampled(32, sampled(first)), *whole)) << first;
}

// A noise threshold shares samples by noise from the 16th on, also in a render that is resumed from fewer.
TEST_F(EdgesOfARender, AreSampledAsInOneRenderWithANoiseThreshold) {
  settings_.noise_threshold = 1e-4f;
  const auto whole = sampled(48);
  EXPECT_GT(range_of_counts(*sampled(16)).second, 20u);
  EXPECT_TRUE(test::same_samples(*sampled(48, sampled(16)), *whole));
  EXPECT_TRUE(test::same_samples(*sampled(48, sampled(32)), *whole));
}

// Regression: the edges of a film without a threshold counted as samples of their whole block.
TEST_F(EdgesOfARender, LetAnAdaptiveRenderGoOn) {
  const auto uniform = sampled(32);
  settings_.noise_threshold = 1e-4f;
  const auto film = sampled(64, uniform);
  const std::vector<uint32_t> before = film::samples_of_pixels(*uniform), after = film::samples_of_pixels(*film);
  double taken = 0.0;
  for (size_t i = 0; i < after.size(); ++i) taken += after[i] - before[i];
  EXPECT_NEAR(taken / double(after.size()), 32.0, 2.0);
}

TEST_F(EdgesOfARender, HaveMoreSamplesInABorder) {
  const uint32_t border[] = {8, 4, 40, 20};
  std::copy_n(border, 4, settings_.region);
  const auto film = sampled(4);
  const auto [low, high] = range_of_counts(*film);
  EXPECT_EQ(low, 4u);
  EXPECT_GE(high, 8u);
  EXPECT_LE(film::mean_samples(*film), 6.0);
}

// Two renders of different samples have different further ones, and a film of both has all of them.
TEST_F(EdgesOfARender, AreMergedWithAllTheirSamples) {
  const auto first = sampled(4);
  settings_.first_sample = 4;
  const auto second = sampled(4);
  film::Film merged = *first;
  render::merge_films(&merged, *second);
  const std::vector<uint32_t> a = film::samples_of_pixels(*first), b = film::samples_of_pixels(*second),
                              sum = film::samples_of_pixels(merged);
  for (size_t i = 0; i < sum.size(); ++i) ASSERT_EQ(sum[i], a[i] + b[i]) << i;
  EXPECT_FALSE(test::same_samples(*first, *second));
  const uint32_t most = render::kMaxFactorAtEdges * kUsual;
  EXPECT_LE(render::first_further_sample(0) + most, render::first_further_sample(kUsual));
}

TEST_F(EdgesOfARender, AreSampledAsOthersWithoutAReconstruction) {
  settings_.reconstruction = GRADUS_RECONSTRUCTION_NONE;
  EXPECT_EQ(range_of_counts(*sampled(8)), std::pair(8u, 8u));
}

}  // namespace
}  // namespace gradus::edge_sampling_test
