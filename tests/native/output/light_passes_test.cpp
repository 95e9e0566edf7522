// Light passes beside a reconstructed picture: they have as little noise as the picture, and add up to it.
#include "output/light_passes.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "render/scene_render.h"
#include "scene/device.h"
#include "schema/pass_table.h"
#include "support/light_sum.h"

namespace gradus::light_passes_test {
namespace {

using test::PathScene;
using test::rendered;
using test::Scenario;

constexpr int kSide = 40;

GradusSettings settings_for(uint32_t reconstruction, uint64_t passes = schema::light_passes()) {
  GradusSettings settings = test::test_settings(kSide, kSide);
  settings.independent_sampler = 0;
  settings.samples = 8;
  settings.threads = 2;
  settings.passes = schema::needed_passes(passes);
  settings.reconstruction = reconstruction;
  if (reconstruction != GRADUS_RECONSTRUCTION_NONE) settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  return settings;
}

std::vector<float> read(const render::Render& render, uint32_t pass) {
  std::vector<float> pixels(schema::pass_info(pass).channels * kSide * kSide);
  render.read_pass(pass, pixels.data(), pixels.size());
  return pixels;
}

void expect_to_add_up(const render::Render& render) {
  test::expect_light_to_add_up([&](uint32_t pass) { return read(render, pass); }, read(render, GRADUS_PASS_COMBINED));
}

class LightPassesBy : public testing::TestWithParam<uint32_t> {};

TEST_P(LightPassesBy, AddUpToCombined) {
  for (const Scenario scenario : {Scenario::Glass, Scenario::GlossyFloor, Scenario::LightsSeen}) {
    GradusSettings settings = settings_for(GetParam());
    settings.film_exposure = 1.7f;
    expect_to_add_up(*rendered(scenario, settings));
  }
}

TEST_P(LightPassesBy, AddUpBesideComponents) {
  GradusSettings settings = settings_for(GetParam());
  settings.use_decomposition = 1;
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  expect_to_add_up(*rendered(Scenario::Glass, settings));
}

// The pass Environment has the world behind the film, which is not in Combined.
TEST_P(LightPassesBy, AddUpOnATransparentFilm) {
  GradusSettings settings = settings_for(GetParam());
  settings.film_transparent = 1;
  const auto render = rendered(Scenario::World, settings);
  const std::vector<float> environment = read(*render, GRADUS_PASS_ENVIRONMENT);
  EXPECT_GT(*std::max_element(environment.begin(), environment.end()), 0.1f);
  const auto read_seen = [&](uint32_t pass) {
    return pass == GRADUS_PASS_ENVIRONMENT ? std::vector<float>(environment.size(), 0.0f) : read(*render, pass);
  };
  test::expect_light_to_add_up(read_seen, read(*render, GRADUS_PASS_COMBINED));
}

// The stand-in adds light everywhere, also where there was none.
TEST_P(LightPassesBy, AddUpBehindADenoiser) {
  GradusDeviceSettings of_device{};
  of_device.struct_size = sizeof(of_device);
  of_device.denoiser_path = GRADUS_BINARY_DIR "/tests/libfake_oidn.so";
  GradusSettings settings = settings_for(GetParam());
  settings.denoiser = GRADUS_DENOISER_OIDN;
  PathScene scene;
  test::build(Scenario::Glass, &scene);
  render::Render render(std::make_shared<scene::Device>(of_device), scene.context(settings).snapshot, settings);
  render.wait(-1.0);
  expect_to_add_up(render);
  EXPECT_GT(read(render, GRADUS_PASS_COMBINED)[0], read(render, GRADUS_PASS_NOISY_IMAGE)[0] + 0.5f);
}

// Regression: light that was smoothed into a pixel without a colour was divided by 0 and lost.
TEST_P(LightPassesBy, LightBesideBlackIsNotLost) {
  PathScene scene;
  test::add_box(&scene, test::matte(Rgb(0.0f)));
  test::add_ceiling_light(&scene, 8.0f, 0.6f);
  scene.ball(Vec3(0.0f, -0.3f, 0.0f), 0.4f, scene.material(test::matte(Rgb(0.8f, 0.0f, 0.4f))), 10, true);
  expect_to_add_up(*rendered(&scene, settings_for(GetParam())));
}

INSTANTIATE_TEST_SUITE_P(Reconstructions, LightPassesBy,
                         testing::Values(uint32_t{GRADUS_RECONSTRUCTION_NONE}, uint32_t{GRADUS_RECONSTRUCTION_L2},
                                         uint32_t{GRADUS_RECONSTRUCTION_L1},
                                         uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED}));

std::vector<float> light_of(const render::Render& render, uint32_t pass) {
  std::vector<float> light = read(render, pass);
  const std::vector<float> color = read(render, schema::pass_info(pass).color);
  for (size_t i = 0; i < light.size(); ++i) light[i] *= color[i];
  return light;
}

// A mean of absolute values, since squares would be dominated by few pixels at the edges of lights.
double distance(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::fabs(double(a[i]) - b[i]);
  return sum;
}

// Returns the sum of the differences between renders with other random numbers.
double noise_of(uint32_t pass, uint32_t reconstruction) {
  GradusSettings settings = settings_for(reconstruction);
  const auto rendered_with = [&](uint32_t seed) {
    settings.seed = seed;
    return light_of(*rendered(Scenario::GlossyFloor, settings), pass);
  };
  double sum = 0.0;
  for (uint32_t seed = 0; seed < 8; seed += 2) sum += distance(rendered_with(seed), rendered_with(seed + 1));
  return sum;
}

TEST(LightPasses, HaveLessNoiseThanTheSamples) {
  for (const uint32_t pass : {GRADUS_PASS_DIFFUSE_DIRECT, GRADUS_PASS_DIFFUSE_INDIRECT, GRADUS_PASS_GLOSSY_INDIRECT}) {
    const double noisy = noise_of(pass, GRADUS_RECONSTRUCTION_NONE);
    ASSERT_GT(noisy, 0.0);
    EXPECT_LT(noise_of(pass, GRADUS_RECONSTRUCTION_REGULARIZED), 0.75 * noisy) << schema::pass_info(pass).name;
    EXPECT_LT(noise_of(pass, GRADUS_RECONSTRUCTION_L1), 0.85 * noisy) << schema::pass_info(pass).name;
  }
}

// Regression: the difference to the brighter picture was added to the noisy passes, so that only the sum was right.
TEST(LightPasses, AreExposedAsThePictureIs) {
  GradusSettings settings = settings_for(GRADUS_RECONSTRUCTION_REGULARIZED);
  const auto once = rendered(Scenario::GlossyFloor, settings);
  settings.film_exposure = 4.0f;
  const auto bright = rendered(Scenario::GlossyFloor, settings);
  for (const schema::PassInfo& info : schema::stored_passes(schema::light_passes())) {
    if (!schema::is_of_light(info.kind)) continue;
    const std::vector<float> a = read(*once, info.pass), b = read(*bright, info.pass);
    for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(4.0f * a[i], b[i], 1e-3f * (1.0f + b[i])) << info.name;
  }
}

TEST(LightPasses, OfTheNoisyImageAreThoseSampled) {
  const auto render = rendered(Scenario::GlossyFloor, settings_for(GRADUS_RECONSTRUCTION_NONE));
  const std::vector<float> noisy = read(*render, GRADUS_PASS_NOISY_IMAGE),
                           combined = read(*render, GRADUS_PASS_COMBINED);
  EXPECT_EQ(noisy, combined);
  expect_to_add_up(*render);
}

// A pass does not depend on the other requested passes: the light that is not requested counts as one more pass.
TEST(LightPasses, OneAloneHasLittleNoiseToo) {
  const auto direct = uint64_t{1} << GRADUS_PASS_DIFFUSE_DIRECT;
  const auto alone = rendered(Scenario::GlossyFloor, settings_for(GRADUS_RECONSTRUCTION_REGULARIZED, direct));
  const auto all = rendered(Scenario::GlossyFloor, settings_for(GRADUS_RECONSTRUCTION_REGULARIZED));
  const auto noisy = rendered(Scenario::GlossyFloor, settings_for(GRADUS_RECONSTRUCTION_NONE));
  const std::vector<float> light = light_of(*all, GRADUS_PASS_DIFFUSE_DIRECT);
  EXPECT_LT(distance(light_of(*alone, GRADUS_PASS_DIFFUSE_DIRECT), light),
            0.3 * distance(light_of(*noisy, GRADUS_PASS_DIFFUSE_DIRECT), light));
  EXPECT_THROW(read(*alone, GRADUS_PASS_DIFFUSE_INDIRECT), Error);
}

TEST(LightPasses, UnrequestedOnesTakeNoMemory) {
  const auto none = rendered(Scenario::GlossyFloor, settings_for(GRADUS_RECONSTRUCTION_REGULARIZED, 0));
  EXPECT_FALSE(output::has_light_passes(*none->film()));
  const auto all = rendered(Scenario::GlossyFloor, settings_for(GRADUS_RECONSTRUCTION_REGULARIZED));
  const auto kept = [](const render::Render& render) {
    return render.progress().memory_bytes - render.film()->memory_bytes();
  };
  EXPECT_EQ(kept(*all) - kept(*none), 8 * 3 * sizeof(float) * kSide * kSide);
}

// The noise of a single sample is unknown.
TEST(LightPasses, OfOneSampleAddUp) {
  GradusSettings settings = settings_for(GRADUS_RECONSTRUCTION_REGULARIZED);
  settings.samples = 1;
  expect_to_add_up(*rendered(Scenario::Glass, settings));
}

TEST(LightPasses, OfACancelledRenderAreThoseSampled) {
  const CancelCheck at_once = [] { return true; };
  const auto render = rendered(Scenario::Glass, settings_for(GRADUS_RECONSTRUCTION_REGULARIZED));
  const std::vector<float> rgba = read(*render, GRADUS_PASS_COMBINED);
  EXPECT_THROW(output::split_light(*render->film(), {0, 0, kSide, kSide}, rgba,
                                   output::read_light_terms(*render->film()), at_once),
               Error);
}

}  // namespace
}  // namespace gradus::light_passes_test
