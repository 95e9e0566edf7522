// A denoiser after the reconstruction, by a stand-in: what it changes, what it leaves, and what is reported.
#include <chrono>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "film/features.h"
#include "output/denoise_combined.h"
#include "output/film_reader.h"
#include "output/oidn_library.h"
#include "reconstruct/regression/feature_filter.h"
#include "render/fake_integrator.h"
#include "scene/device.h"

namespace gradus::denoise_test {
namespace {

using namespace test;
using nlohmann::json;

const std::string kFake = GRADUS_BINARY_DIR "/tests/libfake_oidn.so";
constexpr Region kAll{0, 0, 40, 30};

std::shared_ptr<scene::Device> device_with(const std::string& denoiser) {
  GradusDeviceSettings settings{};
  settings.struct_size = sizeof(settings);
  settings.denoiser_path = denoiser.c_str();
  return std::make_shared<scene::Device>(settings);
}

GradusSettings settings_with(uint32_t denoiser) {
  GradusSettings settings = small_settings(40, 30, 4);
  settings.denoiser = denoiser;
  settings.film_transparent = 1;
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = GRADUS_RECONSTRUCTION_L1;
  return settings;
}

class DenoisedRender : public ::testing::Test {
 protected:
  void TearDown() override { unsetenv("FAKE_OIDN"); }
  std::unique_ptr<render::Render> start(const GradusSettings& settings, float noise = 1.0f, float light = 1.0f) const {
    return std::make_unique<render::Render>(device, empty_snapshot(), settings, nullptr,
                                            fake_factory([=](FakeIntegrator* f) {
                                              f->noise = noise;
                                              f->light = light;
                                            }));
  }
  std::unique_ptr<render::Render> finished(const GradusSettings& settings, float noise = 1.0f,
                                           float light = 1.0f) const {
    auto render = start(settings, noise, light);
    render->wait(-1.0);
    return render;
  }
  const std::shared_ptr<scene::Device> device = device_with(kFake);
};

// Returns the result of the stand-in for a picture and its features without noise.
std::vector<float> denoised(std::vector<float> rgba, const film::Film& film) {
  const film::Features features = reconstruct::filter_features(film::read_features(film));
  for (size_t i = 0; i < rgba.size(); ++i) {
    const size_t g = i / 4 * 3 + i % 4;
    if (i % 4 < 3) rgba[i] += 1.0f + features.albedo.values[g] + 10.0f * features.normal.values[g];
  }
  return rgba;
}

void expect_near(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-4) << i;
}

TEST_F(DenoisedRender, CombinedIsDenoisedAndOtherPassesAreNot) {
  for (const float noise : {0.0f, 1.0f}) {
    const auto plain = finished(settings_with(GRADUS_DENOISER_NONE), noise),
               render = finished(settings_with(GRADUS_DENOISER_OIDN), noise);
    const auto expected = denoised(read(*plain, GRADUS_PASS_COMBINED, kAll), *render->film());
    expect_near(read(*render, GRADUS_PASS_COMBINED, kAll), expected);
    EXPECT_EQ(read(*render, GRADUS_PASS_NOISY_IMAGE, kAll), read(*plain, GRADUS_PASS_NOISY_IMAGE, kAll));
    EXPECT_TRUE(film::has_features(*render->film())) << "the passes were not requested";
    EXPECT_FALSE(film::has_features(*plain->film()));
  }
}

TEST_F(DenoisedRender, IsReportedInStatsPlanAndFilm) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_AUTO);
  settings.samples = 8;
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  const auto render = finished(settings);
  const json stats = json::parse(render->stats_json());
  EXPECT_EQ(stats["denoiser"], "Open Image Denoise 2.7.5");
  EXPECT_EQ(stats["plan"]["chosen"]["denoiser Open Image Denoise 2.7.5"], "automatic: a denoiser is available");
  EXPECT_EQ(stats["unbiased"], false);
  EXPECT_GT(stats["seconds"]["denoise"], 0.0);
  EXPECT_GE(stats["cpu_seconds"]["denoise"], 0.0);
  EXPECT_EQ(render->film()->settings.denoiser, uint32_t{GRADUS_DENOISER_OIDN});
  settings.denoiser = GRADUS_DENOISER_NONE;
  settings.reconstruction = GRADUS_RECONSTRUCTION_L2;
  const json plain = json::parse(finished(settings)->stats_json());
  EXPECT_TRUE(plain["denoiser"].is_null());
  EXPECT_EQ(plain["plan"]["skipped"]["denoiser"], "denoiser is none");
  EXPECT_EQ(plain["unbiased"], true);
  EXPECT_EQ(plain["seconds"]["denoise"], 0.0);
}

// A user who chose L2 or the noisy image expects it to be unbiased.
TEST_F(DenoisedRender, TheAutomaticOneIsLeftOutWithOtherReconstructions) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_AUTO);
  settings.samples = 16;
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_NONE}) {
    settings.reconstruction = reconstruction;
    const json stats = json::parse(finished(settings)->stats_json());
    EXPECT_TRUE(stats["denoiser"].is_null());
    EXPECT_EQ(stats["unbiased"], true);
    EXPECT_EQ(stats["plan"]["skipped"]["denoiser"], reconstruction == GRADUS_RECONSTRUCTION_L2
                                                        ? "automatic: the reconstruction is l2"
                                                        : "automatic: the reconstruction is none");
  }
}

TEST_F(DenoisedRender, TheAutomaticOneIsLeftOutWhereMoreSamplesAreWorthMore) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_AUTO);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.samples = 7;
  const json stats = json::parse(finished(settings)->stats_json());
  EXPECT_TRUE(stats["denoiser"].is_null());
  EXPECT_NE(stats["plan"]["skipped"]["denoiser"].get<std::string>().find("below 8 samples"), std::string::npos);
  settings.denoiser = GRADUS_DENOISER_OIDN;
  EXPECT_EQ(json::parse(finished(settings)->stats_json())["denoiser"], "Open Image Denoise 2.7.5");
}

// Regression: `samples` was used although the time limit determined the number of samples.
TEST_F(DenoisedRender, TheAutomaticOneIsLeftOutWhereTheTimeLimitLeavesFewSamples) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_AUTO);
  settings.samples = 1000;
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.time_limit = 1e-3f;
  const auto slow = [](FakeIntegrator* fake) {
    fake->before = [](const integrator::WorkUnit&) { std::this_thread::sleep_for(std::chrono::milliseconds(2)); };
  };
  render::Render render(device, empty_snapshot(), settings, nullptr, fake_factory(slow));
  render.wait(-1.0);
  const json stats = json::parse(render.stats_json());
  EXPECT_EQ(stats["samples"], 1.0);
  EXPECT_TRUE(stats["denoiser"].is_null());
  EXPECT_EQ(stats["plan"]["skipped"]["denoiser"],
            "automatic: a pixel has 1.0 samples: below 8 samples, more samples reduce the error "
            "more than "
            "the denoiser");
  EXPECT_EQ(render.film()->settings.denoiser, uint32_t{GRADUS_DENOISER_NONE});
  settings.samples = 8;
  settings.time_limit = 1e6f;
  const json quick = json::parse(finished(settings)->stats_json());
  EXPECT_EQ(quick["denoiser"], "Open Image Denoise 2.7.5");
  EXPECT_EQ(quick["plan"]["chosen"]["denoiser Open Image Denoise 2.7.5"], "automatic: a pixel has 8.0 samples");
  EXPECT_EQ(quick["unbiased"], false);
}

TEST_F(DenoisedRender, ARegionIsDenoisedAlone) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_OIDN);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  settings.reconstruction = GRADUS_RECONSTRUCTION_NONE;
  const uint32_t region[] = {10, 5, 30, 20};
  const Region part{10, 5, 30, 20};
  const auto whole = read(*finished(settings), GRADUS_PASS_COMBINED, kAll);
  std::copy(region, region + 4, settings.region);
  const auto image = read(*finished(settings), GRADUS_PASS_COMBINED, part);
  // The filter of the features ends at the region's border, too.
  constexpr int kReach = 3;
  for (int y = kReach; y < 15 - kReach; ++y) {
    for (int x = 4 * kReach; x < 80 - 4 * kReach; ++x)
      ASSERT_NEAR(image[size_t(y) * 80 + size_t(x)], whole[size_t(y + 5) * 160 + size_t(x + 40)], 1e-3);
  }
}

double luminance(const float* pixel) { return (double(pixel[0]) + double(pixel[1]) + double(pixel[2])) / 3.0; }

// A network cannot improve a smooth picture: it denoises the noisy image, and the geometric mean of both is delivered.
TEST_F(DenoisedRender, RegularizedIsTheMeanWithTheDenoisedNoisyImage) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_NONE);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  const auto plain = finished(settings, 0.1f);
  settings.denoiser = GRADUS_DENOISER_OIDN;
  const auto render = finished(settings, 0.1f);
  std::vector<float> expected = denoised(read(*plain, GRADUS_PASS_NOISY_IMAGE, kAll), *render->film());
  const auto regularized = read(*plain, GRADUS_PASS_COMBINED, kAll);
  std::vector<double> lights;
  for (size_t i = 0; i < regularized.size(); i += 4) lights.push_back(luminance(&regularized[i]));
  std::nth_element(lights.begin(), lights.begin() + ptrdiff_t(lights.size() / 2), lights.end());
  const double dark = 0.1 * lights[lights.size() / 2];
  for (size_t i = 0; i < expected.size(); ++i) {
    const double share = i % 4 == 3 ? 0.0 : 0.7;
    expected[i] = float(std::pow(expected[i] + dark, share) * std::pow(regularized[i] + dark, 1.0 - share) - dark);
  }
  expect_near(read(*render, GRADUS_PASS_COMBINED, kAll), expected);
}

// Regression: negative light became black, or colours of pixels beside it. The network reads no negative values, so
// that what is above and what is below zero are denoised by themselves. What the stand-in adds to both cancels.
TEST_F(DenoisedRender, NegativeLightIsKept) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_NONE);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  const auto plain = finished(settings, 0.1f, -1.0f);
  settings.denoiser = GRADUS_DENOISER_OIDN;
  std::vector<float> expected = read(*plain, GRADUS_PASS_COMBINED, kAll);
  const std::vector<float> noisy = read(*plain, GRADUS_PASS_NOISY_IMAGE, kAll);
  for (size_t i = 0; i < expected.size(); ++i)
    if (i % 4 != 3) expected[i] += 0.7f * (noisy[i] - expected[i]);
  EXPECT_LT(*std::min_element(expected.begin(), expected.end()), -0.5f);
  expect_near(read(*finished(settings, 0.1f, -1.0f), GRADUS_PASS_COMBINED, kAll), expected);
}

// The error is known as a share of that of REGULARIZED.
TEST_F(DenoisedRender, ErrorIsThatOfTheDenoisedPicture) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_NONE);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  const auto plain = read(*finished(settings), GRADUS_PASS_ERROR, kAll);
  settings.denoiser = GRADUS_DENOISER_OIDN;
  const auto with = read(*finished(settings), GRADUS_PASS_ERROR, kAll);
  for (size_t i = 0; i < plain.size(); ++i) ASSERT_FLOAT_EQ(with[i], 0.7f * plain[i]) << i;
}

// A border is denoised with the samples around it.
TEST_F(DenoisedRender, ABorderIsThatOfTheFullFrame) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_OIDN);
  settings.integrator = GRADUS_INTEGRATOR_PATH;
  settings.reconstruction = GRADUS_RECONSTRUCTION_NONE;
  const Region part{10, 5, 30, 20};
  const auto whole = read(*finished(settings), GRADUS_PASS_COMBINED, kAll);
  std::vector<float> expected;
  for (int y = part.y0; y < part.y1; ++y) {
    const auto row = whole.begin() + 4 * (y * 40 + part.x0);
    expected.insert(expected.end(), row, row + ptrdiff_t{4} * part.width());
  }
  const uint32_t region[] = {10, 5, 30, 20};
  std::copy(region, region + 4, settings.region);
  expect_near(read(*finished(settings), GRADUS_PASS_COMBINED, part), expected);
}

// A black picture has no median, and its logarithm is not finite.
TEST_F(DenoisedRender, ABlackPictureStaysFinite) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_OIDN);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  for (const float value : read(*finished(settings, 1.0f, 0.0f), GRADUS_PASS_COMBINED, kAll))
    ASSERT_TRUE(std::isfinite(value)) << value;
}

// Regression: the render failed although the picture was complete.
TEST_F(DenoisedRender, AFailureIsAWarningAndThePictureStays) {
  const auto plain = read(*finished(settings_with(GRADUS_DENOISER_NONE)), GRADUS_PASS_COMBINED, kAll);
  auto render = start(settings_with(GRADUS_DENOISER_OIDN));
  setenv("FAKE_OIDN", "fails", 1);
  render->wait(-1.0);
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_OK) << text;
  EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, kAll), plain);
  const json stats = json::parse(render->stats_json());
  ASSERT_EQ(stats["warnings"].size(), 1u);
  EXPECT_NE(stats["warnings"][0].get<std::string>().find("the fake has no memory"), std::string::npos);
  EXPECT_TRUE(stats["denoiser"].is_null());
}

// Regression: `strict` refused only what commit had warned of.
TEST_F(DenoisedRender, AFailureEndsAStrictRender) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_OIDN);
  settings.strict = 1;
  auto render = start(settings);
  setenv("FAKE_OIDN", "fails", 1);
  render->wait(-1.0);
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_ERROR_UNSUPPORTED);
  EXPECT_NE(text.find("strict: the picture was not denoised: Open Image Denoise: the fake has no memory"),
            std::string::npos)
      << text;
}

// Regression: only errors that Open Image Denoise itself reported were caught; others made the render fail.
TEST_F(DenoisedRender, MissingMemoryIsAWarningToo) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_NONE);
  settings.passes |= schema::feature_passes();
  const auto film = finished(settings)->film();
  std::string why_not, failure;
  output::OidnLibrary library = *output::find_oidn({kFake}, &why_not);
  library.api.commit_device = [](output::OidnApi::Device*) { throw std::bad_alloc(); };
  const std::vector<float> combined(4 * size_t(kAll.area()), 0.5f);
  const auto never = [] { return false; };
  const output::CombinedPicture picture{*film, GRADUS_RECONSTRUCTION_REGULARIZED, kAll, combined};
  EXPECT_TRUE(output::denoise_combined(library, picture, 1, never, &failure).empty());
  EXPECT_EQ(failure, "the picture was not denoised: out of memory");
}

TEST_F(DenoisedRender, ACancelDuringItLeavesTheReconstruction) {
  const auto plain = read(*finished(settings_with(GRADUS_DENOISER_NONE)), GRADUS_PASS_COMBINED, kAll);
  setenv("FAKE_OIDN", "slow", 1);
  const auto render = start(settings_with(GRADUS_DENOISER_OIDN));
  while (render->progress().phase < GRADUS_PHASE_RECONSTRUCTING || read(*render, GRADUS_PASS_COMBINED, kAll) != plain) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  render->cancel();
  ASSERT_TRUE(render->wait(1.0)) << "continues";
  EXPECT_EQ(render->outcome(nullptr), GRADUS_ERROR_CANCELLED);
  EXPECT_EQ(read(*render, GRADUS_PASS_COMBINED, kAll), plain);
}

// Regression: a film that was denoised could not be read where there is no denoiser.
TEST_F(DenoisedRender, IsLeftOutWithOneWarningWhereAFilmIsReadWithoutIt) {
  GradusSettings settings = settings_with(GRADUS_DENOISER_OIDN);
  const auto film = finished(settings)->film();
  setenv("FAKE_OIDN", "old", 1);
  std::string why_not;
  if (output::find_oidn({}, &why_not)) GTEST_SKIP() << "this machine has the library";
  const auto plain = read(*finished(settings_with(GRADUS_DENOISER_NONE)), GRADUS_PASS_COMBINED, kAll);
  const auto without = device_with(kFake);
  output::FilmReader reader(film, without);
  std::vector<float> pixels(plain.size());
  for (int i = 0; i < 2; ++i) reader.read_pass(GRADUS_PASS_COMBINED, pixels.data());
  EXPECT_EQ(pixels, plain);
  std::string warning;
  ASSERT_TRUE(without->warnings().take(&warning));
  EXPECT_EQ(warning.find("the picture is not denoised, as its render was: "), 0u) << warning;
  EXPECT_FALSE(without->warnings().take(&warning));
}

TEST_F(DenoisedRender, IsRefusedBeforeTheFirstSampleIfMissing) {
  setenv("FAKE_OIDN", "old", 1);
  std::string why_not;
  if (output::find_oidn({}, &why_not)) GTEST_SKIP() << "this machine has the library";
  try {
    start(settings_with(GRADUS_DENOISER_OIDN));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), GRADUS_ERROR_UNSUPPORTED);
    EXPECT_NE(std::string(e.what()).find("version 1.7.5"), std::string::npos) << e.what();
  }
  GradusSettings settings = settings_with(GRADUS_DENOISER_AUTO);
  settings.samples = 8;
  const auto render = finished(settings);
  const json stats = json::parse(render->stats_json());
  EXPECT_NE(stats["plan"]["skipped"]["denoiser"].get<std::string>().find("version 1.7.5"), std::string::npos);
  EXPECT_EQ(render->film()->settings.denoiser, uint32_t{GRADUS_DENOISER_NONE});
  EXPECT_TRUE(stats["denoiser"].is_null());
  EXPECT_FALSE(film::has_features(*render->film()));
}

}  // namespace
}  // namespace gradus::denoise_test
