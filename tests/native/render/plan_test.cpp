// Choices of the plan, refusals, and their reported reasons.
#include <algorithm>

#include <gtest/gtest.h>

#include "render/fake_integrator.h"
#include "render/plan.h"
#include "render/render.h"
#include "schema/options.h"
#include "schema/pass_table.h"
#include "support/path_scene.h"

namespace gradus::plan_test {
namespace {

using namespace test;

render::Plan plan_for(uint32_t integrator, uint32_t reconstruction) {
  GradusSettings s = small_settings(64, 64, 4);
  s.integrator = integrator;
  s.reconstruction = reconstruction;
  return render::make_plan(s, *empty_snapshot());
}

GradusError refusal(uint32_t integrator, uint32_t reconstruction) {
  try {
    plan_for(integrator, reconstruction);
  } catch (const Error& e) {
    EXPECT_GT(std::string(e.what()).size(), 20u);
    return e.code();
  }
  return GRADUS_OK;
}

TEST(Plan, AutoIsPathWithFeatures) {
  const render::Plan plan = plan_for(GRADUS_INTEGRATOR_AUTO, GRADUS_RECONSTRUCTION_AUTO);
  EXPECT_EQ(plan.integrator, uint32_t{GRADUS_INTEGRATOR_PATH});
  EXPECT_EQ(plan.reconstruction, uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED});
  EXPECT_FALSE(plan.pilot);
  EXPECT_FALSE(render::delivers_unbiased(plan, plan.reconstruction, plan.denoises));
}

TEST(Plan, AutoIsGradientForMethodsThatNeedDifferences) {
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1}) {
    const render::Plan plan = plan_for(GRADUS_INTEGRATOR_AUTO, reconstruction);
    EXPECT_EQ(plan.integrator, uint32_t{GRADUS_INTEGRATOR_GRADIENT});
    EXPECT_TRUE(plan.pilot) << "where gradients reduce the error";
  }
  GradusSettings settings = small_settings(64, 64, 4);
  settings.passes |= uint64_t{1} << GRADUS_PASS_GRADIENT_X;
  settings.integrator = GRADUS_INTEGRATOR_AUTO;
  settings.reconstruction = GRADUS_RECONSTRUCTION_AUTO;
  const render::Plan plan = render::make_plan(settings, *empty_snapshot());
  EXPECT_TRUE(plan.gradients);
  EXPECT_FALSE(plan.pilot) << "its passes are requested";
}

// Regression: an integrator without an implementation rendered plain paths.
TEST(Plan, EveryIntegratorOfTheSchemaButAutoIsImplemented) {
  PathScene scene;
  build(Scenario::DiffuseArea, &scene);
  const integrator::IntegratorContext context = scene.context(test_settings(4, 4));
  for (const schema::Choice& choice : schema::find_option("integrator")->choices) {
    if (choice.value == GRADUS_INTEGRATOR_AUTO) continue;
    EXPECT_NE(render::make_integrator(context, choice.value), nullptr) << choice.name;
  }
  EXPECT_THROW(render::make_integrator(context, GRADUS_INTEGRATOR_AUTO), Error);
  EXPECT_THROW(render::make_integrator(context, 1000), Error);
}

TEST(Plan, PathHasNoGradientsAndReportsIt) {
  const render::Plan plan = plan_for(GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_AUTO);
  EXPECT_EQ(plan.reconstruction, uint32_t{GRADUS_RECONSTRUCTION_NONE});
  EXPECT_FALSE(plan.gradients);
  const auto has = [&](const std::string& what) {
    return std::any_of(plan.skipped.begin(), plan.skipped.end(),
                       [&](const auto& entry) { return entry.first == what; });
  };
  EXPECT_TRUE(has("gradients"));
  EXPECT_TRUE(has("reconstruction"));
  EXPECT_TRUE(has("lens samples"));
}

TEST(Plan, KeepsRequestedPassesAndThoseThatTheReconstructionReads) {
  GradusSettings settings = small_settings(64, 64, 4);
  settings.reconstruction = GRADUS_RECONSTRUCTION_NONE;
  settings.passes |= uint64_t{1} << GRADUS_PASS_MIST;
  EXPECT_EQ(render::make_plan(settings, *empty_snapshot()).passes, settings.passes);
  render::Plan plan;
  for (const uint32_t reconstruction :
       {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1}) {
    plan.reconstruction = reconstruction;
    EXPECT_FALSE(render::features_wanted(plan));
  }
  plan.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  EXPECT_TRUE(render::features_wanted(plan));
}

// Regression: where the pilot found that gradients do not pay, any reconstruction was dropped.
TEST(Plan, WithoutGradientsAReconstructionByFeaturesIsKept) {
  render::Plan plan;
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_L2, GRADUS_RECONSTRUCTION_L1}) {
    plan.reconstruction = reconstruction;
    EXPECT_EQ(render::without_gradients(plan), uint32_t{GRADUS_RECONSTRUCTION_NONE});
  }
  for (const uint32_t reconstruction : {GRADUS_RECONSTRUCTION_NONE, GRADUS_RECONSTRUCTION_REGULARIZED}) {
    plan.reconstruction = reconstruction;
    EXPECT_EQ(render::without_gradients(plan), reconstruction);
  }
}

// Regression: the threshold was 0.1 for every value of the setting.
TEST(Plan, HalfVectorShiftsUseTheThresholdOfTheSettings) {
  auto snapshot = std::make_shared<scene::Snapshot>(*empty_snapshot());
  const auto skips = [&](float sharpest, float threshold) {
    snapshot->features.min_alpha = sharpest;
    GradusSettings s = small_settings(64, 64, 4);
    s.roughness_threshold = threshold;
    const render::Plan plan = render::make_plan(s, *snapshot);
    return std::any_of(plan.skipped.begin(), plan.skipped.end(),
                       [](const auto& entry) { return entry.first == "half-vector shifts"; });
  };
  EXPECT_FALSE(skips(0.2f, 0.5f));
  EXPECT_TRUE(skips(0.2f, 0.1f));
  EXPECT_TRUE(skips(0.05f, 0.01f));
  EXPECT_FALSE(skips(0.0f, 0.0f)) << "mirrors";
}

TEST(Plan, UsesTheSettingsOrRefuses) {
  EXPECT_EQ(refusal(GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_L2), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(refusal(GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_L1), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(refusal(GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1), GRADUS_OK);
  EXPECT_EQ(refusal(GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_REGULARIZED), GRADUS_OK);
  EXPECT_EQ(refusal(GRADUS_INTEGRATOR_PATH, GRADUS_RECONSTRUCTION_REGULARIZED), GRADUS_OK);
  EXPECT_EQ(refusal(7, GRADUS_RECONSTRUCTION_AUTO), GRADUS_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(refusal(GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_NONE), GRADUS_OK);
  EXPECT_FALSE(render::delivers_unbiased(plan_for(GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1),
                                         GRADUS_RECONSTRUCTION_L1, false));
}

TEST(Plan, RefusesRegionsOutsideTheFrame) {
  GradusSettings s = small_settings(64, 64, 4);
  const uint32_t bad[][4] = {{0, 0, 65, 64}, {10, 10, 10, 20}, {30, 10, 20, 20}, {0, 0, 0, 5}};
  for (const auto& region : bad) {
    std::copy(region, region + 4, s.region);
    EXPECT_THROW(render::make_plan(s, *empty_snapshot()), Error);
  }
}

TEST(E8_Sizes, ZeroSamplesGiveAMessage) {
  GradusSettings s = small_settings(64, 64, 0);
  try {
    render::make_plan(s, *empty_snapshot());
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("0 samples"), std::string::npos);
  }
}

// Regression: along a straight edge, both half-buffers agree on the same wrong coverage; a low threshold stopped such
// blocks at 16 samples.
TEST(Plan, LowThresholdsRequireMoreSamplesBeforeBlocksStop) {
  GradusSettings s = small_settings(64, 64, 1024);
  const auto first_check = [&](float threshold, uint32_t minimum) {
    s.noise_threshold = threshold;
    s.min_samples = minimum;
    return render::make_plan(s, *empty_snapshot()).first_check;
  };
  EXPECT_EQ(first_check(0.05f, 0), 16u);
  EXPECT_EQ(first_check(0.01f, 0), 16u);
  EXPECT_EQ(first_check(0.002f, 0), 80u);
  EXPECT_EQ(first_check(0.002f, 20), 20u);
  EXPECT_EQ(first_check(0.01f, 4), 16u);
}

TEST(Plan, DenoiserIsBiasedAndRequestsFeatures) {
  GradusSettings s = small_settings(64, 64, 4);
  s.reconstruction = GRADUS_RECONSTRUCTION_L2;
  s.denoiser = GRADUS_DENOISER_OIDN;
  const render::Plan plain = render::make_plan(s, *empty_snapshot()),
                     denoised = render::make_plan(s, *empty_snapshot(), {"Some Denoiser 1.2.3", ""});
  EXPECT_TRUE(render::delivers_unbiased(plain, plain.reconstruction, plain.denoises));
  EXPECT_FALSE(render::delivers_unbiased(denoised, denoised.reconstruction, denoised.denoises));
  EXPECT_EQ(plain.passes & schema::feature_passes(), 0u);
  EXPECT_EQ(denoised.passes & schema::feature_passes(), schema::feature_passes());
}

TEST(Plan, AutomaticDenoiserDependsOnTheSamplesTaken) {
  struct Case {
    uint32_t samples;
    float time_limit, noise_threshold;
    double taken;
    bool denoises;
  };
  for (const Case& c : {Case{7, 0.0f, 0.0f, 7.0, false},
                        {8, 0.0f, 0.0f, 8.0, true},
                        {7, 60.0f, 0.0f, 7.0, false},
                        {500, 60.0f, 0.0f, 7.9, false},
                        {500, 60.0f, 0.0f, 8.0, true},
                        {500, 0.0f, 0.1f, 16.0, true},
                        {500, 60.0f, 0.1f, 5.0, false}}) {
    GradusSettings s = small_settings(64, 64, c.samples);
    s.denoiser = GRADUS_DENOISER_AUTO;
    s.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
    s.time_limit = c.time_limit;
    s.noise_threshold = c.noise_threshold;
    const render::Plan plan = render::make_plan(s, *empty_snapshot(), {"Some Denoiser 1.2.3", ""});
    render::Reasons chosen = plan.chosen, skipped = plan.skipped;
    EXPECT_EQ(render::denoises_after(plan, c.taken, &chosen, &skipped), c.denoises) << c.samples << " " << c.taken;
    const auto names = [](const render::Reasons& list, const std::string& what) {
      return std::count_if(list.begin(), list.end(), [&](const auto& reason) { return reason.first == what; });
    };
    EXPECT_EQ(names(chosen, "denoiser Some Denoiser 1.2.3"), c.denoises ? 1 : 0);
    EXPECT_EQ(names(skipped, "denoiser"), c.denoises ? 0 : 1);
  }
  GradusSettings requested = small_settings(64, 64, 1);
  requested.denoiser = GRADUS_DENOISER_OIDN;
  requested.time_limit = 60.0f;
  render::Reasons none;
  EXPECT_TRUE(render::denoises_after(render::make_plan(requested, *empty_snapshot(), {"Some Denoiser 1.2.3", ""}), 1.0,
                                     &none, &none));
  EXPECT_TRUE(none.empty());
}

TEST(Plan, NoCameraIsAnError) {
  auto snapshot = std::make_shared<scene::Snapshot>();
  EXPECT_THROW(render::Render(nullptr, snapshot, small_settings(8, 8, 1), nullptr, fake_factory()), Error);
}

}  // namespace
}  // namespace gradus::plan_test
