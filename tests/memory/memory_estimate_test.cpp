// Compares the estimated memory of a render with its peak, and tests the warnings that depend on the estimate.
#include <filesystem>

#include <gtest/gtest.h>

#include "memory/allocations.h"
#include "render/fake_integrator.h"
#include "render/memory_estimate.h"
#include "schema/options.h"

namespace gradus::memory::memory_estimate_test {
namespace {

constexpr uint32_t kWidth = 400, kHeight = 300;  // memory of rows and threads is small beside it

// Settings of a render. With `gaps` the integrator is AUTO, whose pilot leaves parts of the picture without gradients.
struct Case {
  const char* name;
  uint32_t integrator, reconstruction;
  bool adaptive = false, gaps = false;
  const char* components = nullptr;
};

class MemoryEstimate : public ::testing::TestWithParam<Case> {};

GradusSettings settings_of(const Case& c) {
  GradusSettings settings = test::small_settings(kWidth, kHeight, c.adaptive ? 20 : 2);
  settings.threads = 1;
  settings.integrator = c.gaps ? uint32_t{GRADUS_INTEGRATOR_AUTO} : c.integrator;  // AUTO runs a pilot
  settings.reconstruction = c.reconstruction;
  settings.noise_threshold = c.adaptive ? 1e-6f : 0.0f;
  settings.passes |= uint64_t{1} << GRADUS_PASS_NORMAL | schema::feature_passes();
  if (c.components != nullptr) {
    settings.use_decomposition = 1;
    settings.component_passes = 1u << GRADUS_COMPONENT_COLOR | 1u << GRADUS_COMPONENT_NORMAL;
    schema::set_text(&settings, *schema::find_option("components"), c.components);
  }
  return settings;
}

// The estimate must be within a factor of 2 of the peak, which is enough to find renders that do not fit into memory.
TEST_P(MemoryEstimate, IsNearTheRendersPeak) {
  const GradusSettings settings = settings_of(GetParam());
  const auto factory =
      test::fake_factory([](test::FakeIntegrator* fake) { fake->pairs_until = GetParam().gaps ? 350 : INT32_MAX; });
  const uint64_t estimate = render::estimated_memory(render::make_plan(settings, *test::empty_snapshot()));
  const int64_t before = live_bytes();
  forget_peak();
  const auto render = std::make_unique<render::Render>(nullptr, test::empty_snapshot(), settings, nullptr, factory);
  render->wait(-1.0);
  const double taken = double(peak_bytes() - before), pixels = kWidth * kHeight;
  std::printf("  %.0f bytes per pixel, estimated %.0f\n", taken / pixels, double(estimate) / pixels);
  EXPECT_GE(double(estimate), taken / 2.0);
  EXPECT_LE(double(estimate), taken * 2.0);
}

constexpr uint32_t kPath = GRADUS_INTEGRATOR_PATH, kGradient = GRADUS_INTEGRATOR_GRADIENT;

INSTANTIATE_TEST_SUITE_P(All, MemoryEstimate,
                         ::testing::Values(Case{"Path", kPath, GRADUS_RECONSTRUCTION_NONE},
                                           Case{"Noisy", kGradient, GRADUS_RECONSTRUCTION_NONE},
                                           Case{"PathRegularized", kPath, GRADUS_RECONSTRUCTION_REGULARIZED},
                                           Case{"Regularized", kGradient, GRADUS_RECONSTRUCTION_REGULARIZED, true},
                                           Case{"L2", kGradient, GRADUS_RECONSTRUCTION_L2},
                                           Case{"L2WithGaps", kGradient, GRADUS_RECONSTRUCTION_L2, false, true},
                                           Case{"L1", kGradient, GRADUS_RECONSTRUCTION_L1, true},
                                           Case{"Components", kPath, GRADUS_RECONSTRUCTION_REGULARIZED, false, false,
                                                "Once=EDL;Twice=EDDL"}),
                         [](const ::testing::TestParamInfo<Case>& info) { return std::string(info.param.name); });

TEST(MemoryWarning, IsIssuedWhereTheMachineHasLess) {
  constexpr uint64_t gib = uint64_t{1} << 30;
  EXPECT_EQ(render::memory_warning(5 * gib, 5 * gib), "");
  EXPECT_EQ(render::memory_warning(5 * gib, 0), "") << "the memory of the machine is unknown";
  EXPECT_EQ(
      render::memory_warning(6 * gib, 5 * gib),
      "the render takes about 6 GiB of memory, and the machine has 5 GiB: render fewer pixels, passes or components");
  GradusSettings settings = test::small_settings(65536, 65536, 4);
  const uint64_t estimate = render::estimated_memory(render::make_plan(settings, *test::empty_snapshot()));
  EXPECT_NE(render::memory_warning(estimate, 64 * gib), "");
  EXPECT_GT(render::estimated_memory(render::make_plan(settings, *test::empty_snapshot(), {"a denoiser", ""})),
            estimate);
}

// The warning comes before the render, because an animation of nine hours had failed when the disk was full.
TEST(DiskWarning, NamesTheFolderThatIsTooSmall) {
  const std::string folder = std::filesystem::temp_directory_path();
  EXPECT_EQ(render::disk_warning(0, folder), "");
  EXPECT_EQ(render::disk_warning(uint64_t{1} << 60, folder + "/that/is/not/there"), "") << "the free space is unknown";
  EXPECT_NE(render::disk_warning(uint64_t{1} << 60, folder).find(folder), std::string::npos);
}

}  // namespace
}  // namespace gradus::memory::memory_estimate_test
