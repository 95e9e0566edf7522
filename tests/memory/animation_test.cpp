// Compares the estimated memory and disk space of an animation with what it uses.
#include <filesystem>

#include <gtest/gtest.h>

#include "animation/sequence.h"
#include "animation/sequence_fixture.h"
#include "memory/allocations.h"
#include "render/fake_integrator.h"
#include "render/memory_estimate.h"
#include "scene/device.h"

namespace gradus::memory::animation_test {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kWidth = 320, kHeight = 180;
constexpr int kFrames = 12;

// A combination of integrator and reconstruction.
struct Job {
  const char* name;
  uint32_t integrator, reconstruction;
};

class AnimationEstimate : public ::testing::TestWithParam<Job> {};

GradusSettings settings_of(const Job& job, int32_t frame) {
  GradusSettings settings = test::small_settings(kWidth, kHeight, 4);
  settings.threads = 1;
  settings.frame = frame;
  settings.integrator = job.integrator;
  settings.reconstruction = job.reconstruction;
  settings.passes |= uint64_t{1} << GRADUS_PASS_NORMAL | schema::feature_passes();
  return settings;
}

uint64_t bytes_in(const std::string& folder) {
  uint64_t bytes = 0;
  for (const auto& file : fs::directory_iterator(folder)) bytes += file.file_size();
  return bytes;
}

void finish(std::unique_ptr<render::RenderTask> task) {
  task->run();
  std::string text;
  ASSERT_EQ(task->outcome(&text), GRADUS_OK) << text;
}

// The estimate must be within a factor of 2 of the peak, which is enough to find animations that do not fit into
// memory.
TEST_P(AnimationEstimate, IsNearThePeak) {
  const std::string folder = fs::temp_directory_path() / "gradus-animation-estimate";
  fs::remove_all(folder);
  const render::Plan plan = render::make_plan(settings_of(GetParam(), 0), *test::empty_snapshot());
  // A pan: frames of equal content would not be sampled, and those of a shot change not joined.
  test::Pan pan(1.0f);
  std::vector<std::shared_ptr<const scene::Snapshot>> snapshots;
  for (int32_t frame = 0; frame < kFrames; ++frame) snapshots.push_back(pan.at(frame));
  const int64_t before = live_bytes();
  forget_peak();
  {
    const auto sequence = std::make_shared<animation::Sequence>(
        nullptr, animation::SequenceSettings{0, kFrames - 1, 1, {}, folder}, test::fake_factory());
    int32_t sampled = 0;
    for (int32_t frame = 0; frame < kFrames; ++frame) {
      for (; sampled <= sequence->needs(settings_of(GetParam(), frame)).last; ++sampled) {
        finish(sequence->sample(snapshots[size_t(sampled)], settings_of(GetParam(), sampled)));
      }
      const GradusSettings settings = settings_of(GetParam(), frame);
      finish(sequence->deliver(frame, &settings));
    }
  }
  const double taken = double(peak_bytes() - before), pixels = kWidth * kHeight, written = double(bytes_in(folder));
  fs::remove_all(folder);
  const auto memory = double(render::estimated_memory(plan, reconstruct::WindowShape{})),
             files = double(render::estimated_files(plan, kFrames));
  std::printf("  %.0f bytes of memory per pixel, estimated %.0f; files %.0f, estimated %.0f\n", taken / pixels,
              memory / pixels, written / pixels, files / pixels);
  EXPECT_GE(memory, taken / 2.0);
  EXPECT_LE(memory, taken * 2.0);
  EXPECT_GE(files, written);
}

INSTANTIATE_TEST_SUITE_P(
    All, AnimationEstimate,
    ::testing::Values(Job{"L2", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2},
                      Job{"L1", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1},
                      Job{"Regularized", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_REGULARIZED},
                      Job{"RegularizedPath", GRADUS_INTEGRATOR_AUTO, GRADUS_RECONSTRUCTION_REGULARIZED}),
    [](const ::testing::TestParamInfo<Job>& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace gradus::memory::animation_test
