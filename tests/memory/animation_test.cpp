// What an animation is planned to take of memory and disks, against what it takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/device.h"
#include "memory/allocations.h"
#include "render/fake_integrator.h"
#include "render/sequence/sequence.h"

namespace gradus::memory {
namespace {

namespace fs = std::filesystem;

constexpr uint32_t kWidth = 320, kHeight = 180;
constexpr int kFrames = 12;

struct Job {
  const char* name;
  uint32_t integrator, reconstruction;
  bool transparent = false, error = false;
};

class PlannedAnimation : public ::testing::TestWithParam<Job> {};

GradusSettings settings_of(const Job& job, int32_t frame) {
  GradusSettings settings = test::small_settings(kWidth, kHeight, 4);
  settings.threads = 1;
  settings.frame = frame;
  settings.integrator = job.integrator;
  settings.reconstruction = job.reconstruction;
  settings.film_transparent = job.transparent ? 1 : 0;
  settings.passes |= uint64_t{1} << GRADUS_PASS_NORMAL | feature_passes();
  if (job.error) settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return settings;
}

uint64_t bytes_in(const std::string& folder) {
  uint64_t bytes = 0;
  for (const auto& file : fs::directory_iterator(folder)) bytes += file.file_size();
  return bytes;
}

void finish(std::unique_ptr<RenderTask> task, nlohmann::json* stats = nullptr) {
  task->run();
  std::string text;
  ASSERT_EQ(task->outcome(&text), GRADUS_OK) << text;
  if (stats != nullptr) *stats = nlohmann::json::parse(task->stats());
}

TEST_P(PlannedAnimation, TakesWhatIsPlanned) {
  const std::string folder = fs::temp_directory_path() / "gradus-planned-animation";
  fs::remove_all(folder);
  const int64_t before = live_bytes();
  int64_t most_kept = 0;
  forget_peak();
  nlohmann::json stats;
  {
    const auto sequence = std::make_shared<Sequence>(nullptr, SequenceSettings{0, kFrames - 1, 1, {}, folder}, test::fake_factory());
    int32_t sampled = 0;
    for (int32_t frame = 0; frame < kFrames; ++frame) {
      for (; sampled <= sequence->needs(frame).last; ++sampled) {
        finish(sequence->sample(test::empty_snapshot(), settings_of(GetParam(), sampled)));
      }
      const GradusSettings settings = settings_of(GetParam(), frame);
      finish(sequence->deliver(frame, &settings), &stats);
      most_kept = std::max(most_kept, live_bytes() - before);
    }
  }
  const double taken = double(peak_bytes() - before), pixels = kWidth * kHeight, files = double(bytes_in(folder));
  fs::remove_all(folder);
  const double memory = stats["planned_bytes"]["memory"], kept = stats["planned_bytes"]["kept"], frames = stats["planned_bytes"]["frames"];
  std::printf("  %.0f bytes of memory per pixel, planned %.0f; between frames %.0f, planned %.0f; files %.0f, planned %.0f\n",
              taken / pixels, memory / pixels, double(most_kept) / pixels, kept / pixels, files / pixels, frames / pixels);
  EXPECT_GE(memory, 0.97 * taken);
  EXPECT_LE(memory, 1.4 * taken);
  EXPECT_GE(kept, 0.97 * double(most_kept));
  EXPECT_LE(kept, 1.6 * double(most_kept));
  EXPECT_GE(frames, files);
}

INSTANTIATE_TEST_SUITE_P(All, PlannedAnimation,
                         ::testing::Values(Job{"L2", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2},
                                           Job{"L2Error", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L2, false, true},
                                           Job{"L1", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_L1},
                                           Job{"Regularized", GRADUS_INTEGRATOR_GRADIENT, GRADUS_RECONSTRUCTION_REGULARIZED},
                                           Job{"RegularizedPathTransparent", GRADUS_INTEGRATOR_AUTO, GRADUS_RECONSTRUCTION_REGULARIZED,
                                               true}),
                         [](const ::testing::TestParamInfo<Job>& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace gradus::memory
