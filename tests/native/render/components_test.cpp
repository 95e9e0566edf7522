// Components of a render: planned by what the scene holds, reconstructed, and read by name; they add up to Combined (contract 3.4).
#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/error.h"
#include "frame/features.h"
#include "frame/store.h"
#include "motion/component_motion.h"
#include "reconstruct/reconstruct_frame.h"
#include "render/render.h"
#include "render/resume.h"
#include "settings/options.h"
#include "settings/pass_table.h"
#include "support/path_scene.h"

namespace gradus {
namespace {

using test::PathScene;
using test::Scenario;

constexpr uint32_t kSide = 40;
constexpr uint32_t kAllPasses = (1u << GRADUS_COMPONENT_PASS_COUNT) - 1;

GradusSettings settings_with(const std::string& components, uint32_t reconstruction = GRADUS_RECONSTRUCTION_L2) {
  GradusSettings settings = test::test_settings(kSide, kSide);
  settings.independent_sampler = 0;
  settings.samples = 8;
  settings.threads = 2;
  settings.integrator = GRADUS_INTEGRATOR_GRADIENT;
  settings.reconstruction = reconstruction;
  settings.use_decomposition = 1;
  settings.component_passes = kAllPasses;
  set_text(&settings, *find_option("components"), components);
  return settings;
}

std::unique_ptr<Render> started(PathScene* scene, const GradusSettings& settings) {
  return std::make_unique<Render>(test::test_device(), scene->context(settings).snapshot, settings);
}

std::unique_ptr<Render> rendered(PathScene* scene, const GradusSettings& settings) {
  auto render = started(scene, settings);
  render->wait(-1.0);
  std::string text;
  EXPECT_EQ(render->outcome(&text), GRADUS_OK) << text;
  return render;
}

std::unique_ptr<Render> rendered(Scenario scenario, const GradusSettings& settings) {
  PathScene scene;
  test::build(scenario, &scene);
  return rendered(&scene, settings);
}

std::vector<float> combined(const Render& render) {
  std::vector<float> rgba(4 * kSide * kSide);
  render.read_pass(GRADUS_PASS_COMBINED, rgba.data(), rgba.size());
  return rgba;
}

std::vector<float> component(const Render& render, const std::string& name, uint32_t pass = GRADUS_COMPONENT_COLOR) {
  std::vector<float> values(component_pass_info(pass).channels * kSide * kSide);
  render.read_component(name, pass, values.data(), values.size());
  return values;
}

double sum_of(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += value;
  return sum;
}

const char* const kDefaultNames[] = {"Emission", "Diffuse", "Reflection", "Transmission", "Residual"};

std::string sampled_components(const Render& render) { return component_names(*render.frame()); }

class Modes : public testing::TestWithParam<uint32_t> {};

TEST_P(Modes, ComponentsAddUpToCombined) {
  GradusSettings settings = settings_with("", GetParam());
  settings.film_exposure = 1.7f;
  if (GetParam() == GRADUS_RECONSTRUCTION_NONE) settings.integrator = GRADUS_INTEGRATOR_PATH;
  const auto render = rendered(Scenario::Glass, settings);
  const std::vector<float> rgba = combined(*render);
  std::vector<float> sum(3 * kSide * kSide), magnitude(sum);
  int lit = 0;
  for (const char* const name : kDefaultNames) {
    const std::vector<float> part = component(*render, name);
    for (size_t i = 0; i < part.size(); ++i) {
      sum[i] += part[i];
      magnitude[i] += std::fabs(part[i]);
    }
    lit += sum_of(part) > 1.0 ? 1 : 0;
  }
  EXPECT_GE(lit, 3);
  for (size_t i = 0; i < sum.size(); ++i) ASSERT_NEAR(sum[i], rgba[i / 3 * 4 + i % 3], 2e-6f * (magnitude[i] + 1.0f));
}

INSTANTIATE_TEST_SUITE_P(Components, Modes,
                         testing::Values(uint32_t{GRADUS_RECONSTRUCTION_NONE}, uint32_t{GRADUS_RECONSTRUCTION_L2},
                                         uint32_t{GRADUS_RECONSTRUCTION_WEIGHTED}, uint32_t{GRADUS_RECONSTRUCTION_L1},
                                         uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED}));

// L2 has the same weights everywhere: what was taken apart comes together as if it had not been.
TEST(Components, OfL2AddUpToThePictureOfOne) {
  GradusSettings settings = settings_with("Once=E.L;Twice=E..L");
  const auto many = rendered(Scenario::Glass, settings);
  settings.use_decomposition = 0;
  settings.component_passes = 0;
  const auto one = rendered(Scenario::Glass, settings);
  const std::vector<float> a = combined(*many), b = combined(*one);
  const float scale = *std::max_element(b.begin(), b.end());
  for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-5f * scale) << i;
}

TEST(Components, ThatNoSurfaceCanMakeAreNotSampled) {
  const auto matte = rendered(Scenario::DiffuseArea, settings_with(""));
  EXPECT_EQ(sampled_components(*matte), "Emission, Diffuse");
  EXPECT_NE(matte->stats_json().find("\"components Reflection, Transmission, Residual\""), std::string::npos) << matte->stats_json();
  EXPECT_EQ(sum_of(component(*matte, "Reflection")), 0.0);
  const auto mirror = rendered(Scenario::Mirror, settings_with(""));
  EXPECT_EQ(sampled_components(*mirror), "Emission, Diffuse, Reflection, Residual");
  EXPECT_EQ(sampled_components(*rendered(Scenario::Glass, settings_with(""))), "Emission, Diffuse, Reflection, Transmission, Residual");
  // A user's own set, too, and nothing is taken from it that may come.
  EXPECT_EQ(sampled_components(*rendered(Scenario::DiffuseArea, settings_with("Caustic=ED+(R|T).*L;Rare=EDDDDDDDDDDDDL"))),
            "Rare, Residual");
}

TEST(Components, CostNothingWhereNobodyAsks) {
  GradusSettings settings = settings_with("");
  settings.use_decomposition = 0;
  const auto render = rendered(Scenario::Glass, settings);
  EXPECT_EQ(render->frame()->components.size(), 1u);
  EXPECT_TRUE(render->frame()->components[0].rough[0].empty());
  EXPECT_THROW(component(*render, "Diffuse"), Error);
}

TEST(Components, BadSetsEndTheRenderWithWhatIsWrong) {
  PathScene scene;
  test::build(Scenario::DiffuseArea, &scene);
  for (const char* const set : {"Broken=E(DL", "A=EDL;B=E.L", "NotALetter=EXL"}) {
    const GradusSettings settings = settings_with(set);
    const auto snapshot = scene.context(settings).snapshot;
    try {
      Render render(test::test_device(), snapshot, settings);
      ADD_FAILURE() << set;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), GRADUS_ERROR_INVALID_ARGUMENT) << set;
    }
  }
}

TEST(Components, UnknownNamesAndSizesAreRefused) {
  const auto render = rendered(Scenario::DiffuseArea, settings_with(""));
  EXPECT_THROW(component(*render, "Difuse"), Error);
  std::vector<float> few(7);
  EXPECT_THROW(render->read_component("Diffuse", GRADUS_COMPONENT_COLOR, few.data(), few.size()), Error);
  EXPECT_THROW(render->read_component("Diffuse", GRADUS_COMPONENT_PASS_COUNT, few.data(), few.size()), Error);
}

// A wall of albedo 0.3 and its image in a mirror.
TEST(Components, HaveTheSurfacesThatTheirPathsMeetFirst) {
  PathScene scene;
  const uint64_t wall = scene.material(test::matte(Rgb(0.3f, 0.5f, 0.7f)));
  scene.quad(Vec3(-1, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), wall);
  scene.quad(Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 2, 0), scene.material(test::glossy(0.0f)));
  scene.quad(Vec3(-9, -9, 6), Vec3(0, 18, 0), Vec3(18, 0, 0), scene.material(test::matte(Rgb(0.9f, 0.2f, 0.1f))));
  scene.light(test::make_light(GRADUS_LIGHT_POINT, test::translation(Vec3(0, 0, 2.0f)), Rgb(40.0f)));
  scene.camera(Vec3(0, 0, 3), Vec3(0), 0.3f);
  const auto render = rendered(&scene, settings_with(""));
  const std::vector<float> own = component(*render, "Diffuse", GRADUS_COMPONENT_REFLECTANCE);
  const std::vector<float> behind = component(*render, "Reflection", GRADUS_COMPONENT_REFLECTANCE);
  const std::vector<float> facing = component(*render, "Reflection", GRADUS_COMPONENT_NORMAL);
  const size_t left = 3 * (20 * kSide + 10), right = 3 * (20 * kSide + 30);
  EXPECT_NEAR(own[left + 1], 0.5f, 1e-5f);
  EXPECT_EQ(own[right + 1], 0.0f);
  EXPECT_EQ(behind[left], 0.0f);
  EXPECT_NEAR(behind[right], 0.9f, 1e-5f);
  EXPECT_NEAR(facing[right + 2], -1.0f, 1e-5f);
  const std::vector<float> near = component(*render, "Diffuse", GRADUS_COMPONENT_DEPTH),
                           far = component(*render, "Reflection", GRADUS_COMPONENT_DEPTH);
  EXPECT_NEAR(near[left / 3], 3.0f, 0.05f);
  EXPECT_NEAR(far[right / 3], 9.0f, 0.1f) << "to the mirror and back past the camera";
  EXPECT_EQ(near[right / 3], 1e10f);
  EXPECT_EQ(far[left / 3], 1e10f);
  // Irradiance · reflectance is the colour again; of black surfaces it is the colour itself.
  const std::vector<float> color = component(*render, "Diffuse"), light = component(*render, "Diffuse", GRADUS_COMPONENT_IRRADIANCE);
  EXPECT_GT(color[left], 0.0f);
  EXPECT_NEAR(light[left + 2] * 0.7f, color[left + 2], 1e-5f * color[left + 2]);
  EXPECT_EQ(light[right], color[right]);
}

TEST(Components, AreKeptInFramesAndGoOnFromThere) {
  PathScene scene;
  test::build(Scenario::Glass, &scene);
  GradusSettings settings = settings_with("");
  const auto whole = rendered(&scene, settings);
  settings.samples = 4;
  const auto first = rendered(&scene, settings);
  const std::string path = testing::TempDir() + "gradus_components.exr";
  save_frame(*first->frame(), path);
  const std::shared_ptr<const Frame> stored = load_frame(path);
  EXPECT_EQ(component_names(*stored), component_names(*first->frame()));
  EXPECT_EQ(stored->components[1].expression, "ED.*L");
  for (size_t c = 0; c < stored->components.size(); ++c) {
    EXPECT_EQ(stored->components[c].primal, first->frame()->components[c].primal);
    EXPECT_EQ(stored->components[c].gradient, first->frame()->components[c].gradient);
    const auto &rough = stored->components[c].rough[1], &kept = first->frame()->components[c].rough[1];
    ASSERT_EQ(rough.size(), kept.size());
    EXPECT_EQ(std::memcmp(rough.data(), kept.data(), rough.size() * sizeof(RoughVertices)), 0);
  }
  settings.samples = 8;
  Render more(test::test_device(), scene.context(settings).snapshot, settings, stored);
  ASSERT_TRUE(more.wait(-1.0));
  EXPECT_EQ(combined(more), combined(*whole));
  EXPECT_EQ(component(more, "Transmission"), component(*whole, "Transmission"));
  // Not as other components.
  const GradusSettings others = settings_with("Direct=EDL");
  EXPECT_THROW(Render(test::test_device(), scene.context(others).snapshot, others, stored), Error);
}

TEST(Components, OfDifferentSetsAreNotMerged) {
  Frame a(4, 4, {0, 0, 4, 4}, 3, 2, false), b = a;
  a.components[0].name = "Diffuse";
  b.components[0].name = "Direct";
  b.samples.add({0, 1});
  try {
    merge_frames(&a, b);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("Direct"), std::string::npos) << e.what();
  }
}

constexpr uint32_t kMotionPasses = 1u << GRADUS_COMPONENT_MOTION | 1u << GRADUS_COMPONENT_TRACKED;

std::vector<float> read(const Render& render, const std::string& name, uint32_t pass) {
  std::vector<float> values(component_pass_info(pass).channels * kSide * kSide);
  render.read_component(name, pass, values.data(), values.size());
  return values;
}

// A camera that turns from frame to frame.
void turn_camera(Snapshot* snapshot) {
  std::copy_n(snapshot->camera.matrix, 16, snapshot->camera.matrix_previous);
  snapshot->camera.matrix_previous[12] -= 0.05f;
}

TEST(Components, TellTheirMotion) {
  PathScene scene;
  test::build(Scenario::Glass, &scene);
  GradusSettings settings = settings_with("");
  settings.component_passes = kMotionPasses;
  const IntegratorContext context = scene.context(settings);
  auto moved = std::make_shared<Snapshot>(*context.snapshot);
  turn_camera(moved.get());
  Render render(test::test_device(), moved, settings);
  render.wait(-1.0);
  const ComponentSet set = ComponentSet::parse("");
  const Region region{0, 0, int32_t(kSide), int32_t(kSide)};
  const auto expected = component_motion(*moved, settings, set, kEveryComponent, region);
  float farthest = 0.0f;
  for (int c = 0; c < set.count(); ++c) {
    if (find_component(*render.frame(), set[c].name) < 0) continue;
    const std::vector<float> vectors = read(render, set[c].name, GRADUS_COMPONENT_MOTION);
    const std::vector<float> tracked = read(render, set[c].name, GRADUS_COMPONENT_TRACKED);
    for (size_t i = 0; i < tracked.size(); ++i) {
      const float found = expected[size_t(c)].tracked[i];
      const bool by_flow = set[c].name == kResidual && found == kTracked;  // of two frames
      ASSERT_EQ(tracked[i], by_flow ? kNoNeighbour : found) << set[c].name;
      for (size_t k = 0; k < 4; ++k) ASSERT_EQ(vectors[4 * i + k], expected[size_t(c)].vectors[i][int(k)]) << set[c].name;
      farthest = std::max(farthest, std::fabs(vectors[4 * i]));
    }
  }
  EXPECT_GT(farthest, 0.2f);
}

TEST(Components, WhatIsNotThereIsNotTracked) {
  GradusSettings settings = settings_with("Nothing=ETTTTTTL");
  settings.component_passes = kMotionPasses;
  const auto render = rendered(Scenario::DiffuseArea, settings);
  ASSERT_EQ(find_component(*render->frame(), "Nothing"), -1);
  for (const float value : read(*render, "Nothing", GRADUS_COMPONENT_TRACKED)) ASSERT_EQ(value, kNothingToTrack);
  for (const float value : read(*render, "Nothing", GRADUS_COMPONENT_MOTION)) ASSERT_EQ(value, 0.0f);
}

TEST(Components, MotionThatWasNotAskedForIsRefused) {
  GradusSettings settings = settings_with("");
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  const auto render = rendered(Scenario::Glass, settings);
  std::vector<float> values(kSide * kSide);
  EXPECT_THROW(render->read_component("Diffuse", GRADUS_COMPONENT_TRACKED, values.data(), values.size()), Error);
}

TEST(Components, MotionIsStoredWithTheFrame) {
  GradusSettings settings = settings_with("");
  settings.component_passes = kMotionPasses;
  const auto frame = rendered(Scenario::Glass, settings)->frame();
  const std::string path = (std::filesystem::temp_directory_path() / ("gradus_motion_" + std::to_string(getpid()) + ".exr")).string();
  save_frame(*frame, path);
  const auto back = load_frame(path);
  std::filesystem::remove(path);
  ASSERT_FALSE(frame->components[0].motion.empty());
  EXPECT_TRUE(frame->components[0].shown.empty()) << "of animations alone";
  for (size_t c = 0; c < frame->components.size(); ++c) {
    EXPECT_EQ(back->components[c].motion, frame->components[c].motion);
    EXPECT_EQ(back->components[c].tracked, frame->components[c].tracked);
  }
}

// What only passes show is sampled for them alone.
TEST(Components, KeepNoSurfacesUnlessPassesShowThem) {
  GradusSettings settings = settings_with("", GRADUS_RECONSTRUCTION_REGULARIZED);
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  const auto frame = rendered(Scenario::Glass, settings)->frame();
  for (const ComponentPlanes& planes : frame->components) EXPECT_TRUE(planes.rough[0].empty());
}

// The picture is clamped, and so are its parts: by what there is too much of, nothing is added.
TEST(Components, ThatAreClampedAddUpToThePictureAsClamped) {
  std::vector<std::vector<float>> images = {{2.0f, -1.0f, 1.0f, 0.5f}, {-1.0f, -1.0f, 3.0f, 0.25f}};
  clamp_components(GRADUS_RECONSTRUCTION_WEIGHTED, 4, &images);
  EXPECT_EQ(images[0], (std::vector<float>{1.0f, 0.0f, 1.0f, 0.5f}));
  EXPECT_EQ(images[1], (std::vector<float>{0.0f, 0.0f, 3.0f, 0.25f}));
  std::vector<std::vector<float>> kept = {{2.0f, 0.0f, 0.0f}, {-1.0f, 0.0f, 0.0f}};
  clamp_components(GRADUS_RECONSTRUCTION_L2, 3, &kept);
  EXPECT_EQ(kept[1][0], -1.0f);
}

}  // namespace
}  // namespace gradus
