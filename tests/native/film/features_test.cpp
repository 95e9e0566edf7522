// Features and their variance in a film: by half-buffers, through reading, the store, merging and resuming.
#include "film/features.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "film/film.h"
#include "film_io/store.h"
#include "output/pass_read.h"
#include "render/fake_integrator.h"
#include "render/resume.h"
#include "support/refusal.h"

namespace gradus::features_test {
namespace {

using namespace test;

GradusSettings with_features(uint32_t samples) {
  GradusSettings settings = small_settings(40, 30, samples);
  settings.passes |= schema::feature_passes();
  return settings;
}

GradusSettings without_features(uint32_t samples) {
  GradusSettings settings = small_settings(40, 30, samples);
  settings.reconstruction = GRADUS_RECONSTRUCTION_NONE;
  return settings;
}

// Returns a film with features that the settings do not request, as the plan may decide.
film::Film with_unasked_features() {
  film::Film film = *rendered(with_features(6));
  film.settings.passes = uint64_t{1} << GRADUS_PASS_COMBINED;
  return film;
}

struct StoredFeatures : ::testing::Test {
  ~StoredFeatures() override { std::filesystem::remove(path); }
  const std::string path =
      (std::filesystem::temp_directory_path() / ("gradus_features_" + std::to_string(getpid()) + ".exr")).string();
};

TEST(Features, HalvesAverageToThePass) {
  const auto film = rendered(with_features(5));  // three samples in one half-buffer, two in the other
  ASSERT_TRUE(film::has_features(*film));
  const film::Features both = film::read_features(*film), a = film::read_features(*film, {0, 1}),
                       b = film::read_features(*film, {1, 2});
  EXPECT_EQ(both.width, film->region.width());
  EXPECT_EQ(both.height, film->region.height());
  EXPECT_NE(a.normal.values, b.normal.values);
  std::vector<float> pass(size_t(film->region.area()) * 3);
  output::read_film_pass(*film, GRADUS_PASS_DENOISING_NORMAL, film->region, pass.data());
  // The pass shows normals as the camera sees them.
  std::vector<float> seen(pass.size());
  for (size_t i = 0; i < seen.size(); i += 3) {
    const float* n = &both.normal.values[i];
    const Vec3 turned = film->view_rotation * Vec3(n[0], n[1], n[2]);
    std::copy_n(&turned.x, 3, &seen[i]);
  }
  EXPECT_EQ(film->view_rotation, Mat3(1, 0, 0, 0, 1, 0, 0, 0, -1));  // The camera looks along its own -z.
  EXPECT_EQ(seen, pass);
  EXPECT_TRUE(a.normal.variance.empty());
  for (size_t i = 0; i < pass.size(); ++i) {
    EXPECT_NEAR(both.normal.values[i], (3.0f * a.normal.values[i] + 2.0f * b.normal.values[i]) / 5.0f, 1e-6f);
    const float half = 0.5f * (a.normal.values[i] - b.normal.values[i]);
    EXPECT_NEAR(both.normal.variance[i], half * half, 1e-6f);
  }
  EXPECT_EQ(both.albedo.values.size(), pass.size());
  EXPECT_EQ(both.depth.values.size(), pass.size() / 3);
  EXPECT_EQ(both.depth.variance.size(), pass.size() / 3);
}

TEST(Features, OneHalfAloneHasNoVariance) {
  const auto film = rendered(with_features(1));
  const film::Features features = film::read_features(*film);
  const std::vector<float> none(features.albedo.values.size());
  EXPECT_NE(features.albedo.values, none);
  EXPECT_EQ(film::read_features(*film, {1, 2}).albedo.values, none);
  for (const float v : features.albedo.variance) EXPECT_TRUE(std::isnan(v));
}

TEST(Features, FilmsWithoutThemSaySo) {
  const auto film = rendered(without_features(2));
  EXPECT_FALSE(film::has_features(*film));
  EXPECT_THROW(film::read_features(*film), Error);
  EXPECT_THROW(film::read_feature(*rendered(with_features(2)), GRADUS_PASS_NORMAL), Error) << "not kept in halves";
}

// Counts of pixels and halves differ where pixel blocks stop early.
TEST(Features, FollowTheCountsOfAdaptiveRenders) {
  GradusSettings settings = with_features(64);
  settings.noise_threshold = 1e-3f;
  const auto render = start(settings, fake_factory([](FakeIntegrator* fake) {
                              fake->quiet_until = 16;
                              fake->feature_seed = 0;
                            }));
  ASSERT_TRUE(render->wait(-1.0));
  const std::shared_ptr<const film::Film> film = render->film();
  const auto [minimum, maximum] = std::minmax_element(film->count[0].begin(), film->count[0].end());
  ASSERT_LT(*minimum, *maximum);
  const std::vector<float> depth = film::read_features(*film).depth.values, primal = film::read_images(*film, 0).primal;
  for (size_t i = 0; i < depth.size(); ++i) EXPECT_NEAR(depth[i], primal[3 * i], 1e-5f);  // the scene is built so
}

TEST(Features, HalvesAreMergedSeparately) {
  GradusSettings late = with_features(25);
  late.first_sample = 7;
  film::Film merged = *rendered(with_features(7));
  render::merge_films(&merged, *rendered(late));
  const auto whole = rendered(with_features(32));
  for (int half = 0; half < film::kHalves; ++half) {
    const film::Features a = film::read_features(merged, {half, half + 1}),
                         b = film::read_features(*whole, {half, half + 1});
    for (size_t i = 0; i < a.albedo.values.size(); ++i) EXPECT_NEAR(a.albedo.values[i], b.albedo.values[i], 1e-5f);
  }
}

TEST(L3_Resume, FeaturesHaveTheSameBits) {
  EXPECT_TRUE(same_samples(*rendered(with_features(32), rendered(with_features(7))), *rendered(with_features(32))));
}

// Regression: a reconstruction that reads features would have found half of the samples, or none.
TEST(L3_Resume, RefusesFilmsWithoutTheFeaturesThatTheReconstructionReads) {
  const GradusSettings settings = without_features(16);
  render::Plan plan = render::make_plan(settings, *empty_snapshot());
  const uint64_t scene = empty_snapshot()->content_key;
  film::Film film = *rendered(without_features(8));
  EXPECT_NO_THROW(render::check_resumable(film, settings, plan, scene));
  plan.passes |= schema::feature_passes();
  EXPECT_THROW(render::check_resumable(film, settings, plan, scene), Error);
  EXPECT_NO_THROW(render::check_resumable(with_unasked_features(), settings, plan, scene));
}

TEST_F(StoredFeatures, ComeBackWithTheirHalves) {
  const film::Film film = with_unasked_features();
  film_io::save_film(film, path);
  const auto back = film_io::load_film(path);
  EXPECT_EQ(back->channels.passes(), schema::feature_passes());
  EXPECT_TRUE(same_samples(film, *back));
  EXPECT_EQ(film::read_features(*back).depth.variance, film::read_features(film).depth.variance);
}

// Files of versions before features had halves have one plane of each feature.
TEST_F(StoredFeatures, FilesOfAnotherFormatAreRefused) {
  film_io::save_film(*rendered(with_features(2)), path);
  std::stringstream content;
  content << std::ifstream(path, std::ios::binary).rdbuf();
  std::string bytes = content.str();
  const std::string key = "\"format\":";
  const size_t format = bytes.find(key);
  ASSERT_NE(format, std::string::npos);
  bytes[format + key.size()] = '3';
  std::ofstream(path, std::ios::binary) << bytes;
  const std::string refusal = refusal_of([&] { film_io::load_film(path); });
  EXPECT_NE(refusal.find("another version"), std::string::npos) << refusal;
}

}  // namespace
}  // namespace gradus::features_test
