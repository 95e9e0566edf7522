// The pass Error of renders and of their films.
#include <gtest/gtest.h>

#include "output/developer.h"
#include "render/fake_integrator.h"
#include "render/plan.h"
#include "support/statistics.h"

namespace gradus::error_pass_test {
namespace {

using namespace test;

constexpr uint32_t kSide = 48;
const Region kAll{0, 0, kSide, kSide};

GradusSettings error_settings(uint32_t integrator, uint32_t reconstruction, uint32_t samples = 16) {
  GradusSettings settings = small_settings(kSide, kSide, samples);
  settings.integrator = integrator;
  settings.reconstruction = reconstruction;
  settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return settings;
}

// Returns the mean squared error of a pass against the fake scene's truth, mean over RGB.
double true_error(const std::vector<float>& rgba) {
  double sum = 0.0;
  for (int i = 0; i < int(kSide * kSide); ++i) {
    const float truth = fake_truth(i % int(kSide), i / int(kSide)), factors[3] = {1.0f, 0.5f, 2.0f};
    for (int c = 0; c < 3; ++c) {
      const double e = rgba[4 * size_t(i) + size_t(c)] - factors[c] * truth;
      sum += e * e / 3.0;
    }
  }
  return sum / (kSide * kSide);
}

TEST(ErrorPass, IsThatOfCombined) {
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2}) {
    const auto render = start_and_wait(error_settings(GRADUS_INTEGRATOR_GRADIENT, reconstruction, 64));
    const double truth = true_error(read(*render, GRADUS_PASS_COMBINED, kAll));
    const double ratio = mean(read(*render, GRADUS_PASS_ERROR, kAll)) / truth;
    EXPECT_GT(ratio, 0.75) << reconstruction;
    EXPECT_LT(ratio, 1.25) << reconstruction;
  }
}

// The features of the fake scene are as noisy as its picture. The error that their noise causes in the regression is
// not estimated; more samples would show it.
TEST(ErrorPass, OfRegularizedIsThatOfCombined) {
  for (const uint32_t samples : {2u, 4u, 8u}) {
    const auto render =
        start_and_wait(error_settings(GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_REGULARIZED, samples));
    const double truth = true_error(read(*render, GRADUS_PASS_COMBINED, kAll));
    const double ratio = mean(read(*render, GRADUS_PASS_ERROR, kAll)) / truth;
    EXPECT_GT(ratio, 0.6) << samples;
    EXPECT_LT(ratio, 1.4) << samples;
  }
}

TEST(ErrorPass, IsRefusedIfItWasNotRequested) {
  EXPECT_THROW(read(*start_and_wait(small_settings(kSide, kSide, 4)), GRADUS_PASS_ERROR, kAll), Error);
}

// The error of the delivered picture scales with the square of the exposure.
TEST(ErrorPass, ScalesWithTheExposure) {
  GradusSettings settings = error_settings(GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2);
  const std::vector<float> plain = read(*start_and_wait(settings), GRADUS_PASS_ERROR, kAll);
  settings.film_exposure = 3.0f;
  const std::vector<float> exposed = read(*start_and_wait(settings), GRADUS_PASS_ERROR, kAll);
  for (size_t i = 0; i < plain.size(); ++i) EXPECT_FLOAT_EQ(exposed[i], 9.0f * plain[i]);
}

TEST(ErrorPass, OfARegionHasItsPixels) {
  GradusSettings settings = error_settings(GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_NONE);
  const auto film = rendered(settings);
  const auto error_of = [&](const Region& region) {
    output::DevelopedFilm developed{film, region, 2};
    output::Developer(2).reconstruct(&developed, {.error = true});
    return *developed.find(GRADUS_PASS_ERROR);
  };
  const std::vector<float> whole = error_of(kAll), part = error_of({7, 11, 30, 29});
  ASSERT_EQ(part.size(), 23u * 18u);
  for (size_t i = 0; i < part.size(); ++i) EXPECT_EQ(part[i], whole[(11 + i / 23) * kSide + 7 + i % 23]);
}

// The delivered picture is the noisy image then.
TEST(ErrorPass, AfterACancelIsThatOfTheNoisyImage) {
  auto render = start(error_settings(GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1, 1000000));
  while (render->progress().samples_done < 8) std::this_thread::yield();
  EXPECT_THROW(read(*render, GRADUS_PASS_ERROR, kAll), Error) << "while sampling";
  render->cancel();
  ASSERT_TRUE(render->wait(10.0));
  const std::vector<float> error = read(*render, GRADUS_PASS_ERROR, kAll);
  EXPECT_NEAR(mean(error) / true_error(read(*render, GRADUS_PASS_COMBINED, kAll)), 1.0, 0.2);
}

TEST(ErrorPass, IsReportedWhenItIsSkipped) {
  const auto skips_error = [](const GradusSettings& settings) {
    for (const auto& [what, why] : render::make_plan(settings, *empty_snapshot()).skipped) {
      if (what.find("passes ") == 0 && (what + ",").find(" Error,") != std::string::npos) return true;
    }
    return false;
  };
  EXPECT_TRUE(skips_error(small_settings(kSide, kSide, 4)));
  EXPECT_FALSE(skips_error(error_settings(GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_NONE)));
}

}  // namespace
}  // namespace gradus::error_pass_test
