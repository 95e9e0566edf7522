// Memory that the plan asks of the machine against what a render takes.
#include <gtest/gtest.h>

#include "base/device.h"
#include "memory/allocations.h"
#include "plan/plan.h"
#include "render/fake_integrator.h"
#include "settings/options.h"

namespace gradus::memory {
namespace {

constexpr uint32_t kWidth = 400, kHeight = 300;  // what rows and threads take is little beside

struct Case {
  const char* name;
  uint32_t integrator, reconstruction;
  bool adaptive, transparent, gaps, error = false;
  bool watched = false, denoised = false;
  const char* components = nullptr;
};

// What the plan allows for the network: the stand-in takes nothing.
constexpr uint64_t kNetwork = uint64_t{800} * kWidth * kHeight + (32 << 20);

std::shared_ptr<Device> device_with_denoiser() {
  GradusDeviceSettings settings{};
  settings.struct_size = sizeof(settings);
  settings.denoiser_path = GRADUS_BINARY_DIR "/tests/libfake_oidn.so";
  return std::make_shared<Device>(settings);
}

class PlannedBytes : public ::testing::TestWithParam<Case> {};

GradusSettings settings_of(const Case& c) {
  GradusSettings settings = test::small_settings(kWidth, kHeight, c.adaptive ? 20 : c.watched ? 8 : 2);
  settings.threads = 1;
  settings.integrator = c.gaps ? uint32_t{GRADUS_INTEGRATOR_AUTO} : c.integrator;  // a pilot
  settings.reconstruction = c.reconstruction;
  settings.film_transparent = c.transparent ? 1 : 0;
  settings.noise_threshold = c.adaptive ? 1e-6f : 0.0f;
  settings.passes |= uint64_t{1} << GRADUS_PASS_NORMAL | feature_passes();
  if (c.denoised) settings.denoiser = GRADUS_DENOISER_OIDN;
  if (c.components != nullptr) {
    settings.use_decomposition = 1;
    settings.component_passes = 1u << GRADUS_COMPONENT_COLOR | 1u << GRADUS_COMPONENT_NORMAL;
    set_text(&settings, *find_option("components"), c.components);
  }
  if (c.error) settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return settings;
}

// What the estimate of noise reads was left out, as were alpha's solve and those of L2 after a pilot: up to 230 bytes of 555 per pixel.
TEST_P(PlannedBytes, AreThoseOfTheRendersPeak) {
  const GradusSettings settings = settings_of(GetParam());
  const auto factory = test::fake_factory([](test::FakeIntegrator* fake) {
    fake->pairs_until = GetParam().gaps ? 350 : INT32_MAX;
    if (GetParam().watched) fake->before = [](const WorkUnit&) { std::this_thread::sleep_for(std::chrono::milliseconds(5)); };
  });
  std::vector<float> seen(GetParam().watched ? 4 * size_t{kWidth} * kHeight : 0);
  const std::shared_ptr<Device> device = GetParam().denoised ? device_with_denoiser() : nullptr;
  const HostDenoiser denoiser{device ? "a stand-in" : "", ""};
  const uint64_t planned = planned_bytes(make_plan(settings, *test::empty_snapshot(), denoiser)) - (device ? kNetwork : 0);
  const int64_t before = live_bytes();
  forget_peak();
  const auto render = std::make_unique<Render>(device, test::empty_snapshot(), settings, nullptr, factory);
  do {
    if (!seen.empty()) render->read_pass(GRADUS_PASS_COMBINED, seen.data(), seen.size());
  } while (!render->wait(seen.empty() ? -1.0 : 0.02));
  const double taken = double(peak_bytes() - before), pixels = kWidth * kHeight;
  std::printf("  %.0f bytes per pixel, planned %.0f\n", taken / pixels, double(planned) / pixels);
  EXPECT_GE(double(planned), 0.97 * taken);
  EXPECT_LE(double(planned), 1.25 * taken);
}

INSTANTIATE_TEST_SUITE_P(All, PlannedBytes, ::testing::ValuesIn([] {
                           constexpr uint32_t path = GRADUS_INTEGRATOR_PATH, gradient = GRADUS_INTEGRATOR_GRADIENT;
                           std::vector<Case> all;
                           for (const bool adaptive : {false, true}) {
                             for (const bool transparent : {false, true}) {
                               all.push_back({"Path", path, GRADUS_RECONSTRUCTION_NONE, adaptive, transparent, false});
                               all.push_back({"Noisy", gradient, GRADUS_RECONSTRUCTION_NONE, adaptive, transparent, false});
                               all.push_back({"PathRegularized", path, GRADUS_RECONSTRUCTION_REGULARIZED, adaptive, transparent, false});
                               all.push_back({"Regularized", gradient, GRADUS_RECONSTRUCTION_REGULARIZED, adaptive, transparent, false});
                               all.push_back({"L2", gradient, GRADUS_RECONSTRUCTION_L2, adaptive, transparent, false});
                               all.push_back({"L2WithGaps", gradient, GRADUS_RECONSTRUCTION_L2, adaptive, transparent, true});
                               all.push_back({"L1", gradient, GRADUS_RECONSTRUCTION_L1, adaptive, transparent, false});
                             }
                           }
                           for (const bool transparent : {false, true}) {
                             all.push_back({"PathError", path, GRADUS_RECONSTRUCTION_NONE, false, transparent, false, true});
                             all.push_back({"L2Error", gradient, GRADUS_RECONSTRUCTION_L2, false, transparent, false, true});
                             all.push_back({"L2WithGapsError", gradient, GRADUS_RECONSTRUCTION_L2, false, transparent, true, true});
                             all.push_back({"Denoised", path, GRADUS_RECONSTRUCTION_NONE, false, transparent, false, false, false, true});
                           }
                           all.push_back({"WatchedL2", gradient, GRADUS_RECONSTRUCTION_L2, false, false, false, false, true});
                           all.push_back({"Watched", path, GRADUS_RECONSTRUCTION_REGULARIZED, false, false, false, false, true});
                           const char* const bounces = "Once=EDL;Twice=EDDL;Thrice=EDDDL";
                           Case apart{"Components", path, GRADUS_RECONSTRUCTION_REGULARIZED, false, false, false};
                           apart.components = bounces;
                           all.push_back(apart);
                           apart = {"ComponentsOfL2", gradient, GRADUS_RECONSTRUCTION_L2, false, true, false};
                           apart.components = bounces;
                           all.push_back(apart);
                           return all;
                         }()),
                         [](const ::testing::TestParamInfo<Case>& info) {
                           const Case& c = info.param;
                           return std::string(c.name) + (c.adaptive ? "Adaptive" : "") + (c.transparent ? "Transparent" : "");
                         });

}  // namespace
}  // namespace gradus::memory
