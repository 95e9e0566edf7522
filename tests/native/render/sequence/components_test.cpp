// Components of animations: each has windows of its own, and they add up.
#include <algorithm>
#include <cmath>

#include "render/sequence/sequence_fixture.h"
#include "settings/options.h"

namespace gradus {
namespace {

using namespace test;

constexpr int32_t kLast = 3;

GradusSettings settings_for(int32_t frame, uint32_t reconstruction, const char* components) {
  GradusSettings settings = settings_of(frame);
  settings.reconstruction = reconstruction;
  if (components == nullptr) return settings;
  settings.use_decomposition = 1;
  settings.component_passes = 1u << GRADUS_COMPONENT_COLOR;
  set_text(&settings, *find_option("components"), components);
  return settings;
}

// Pictures of all frames, and beside each the sum of its components.
struct Pictures {
  std::vector<std::vector<float>> combined, sums;
  std::vector<double> light;  // of each component, in the last frame
};

Pictures rendered(uint32_t reconstruction, const char* components) {
  Pan pan(1.0f, Scenario::Glass);
  const auto sequence = make_sequence(0, kLast);
  for (int32_t frame = 0; frame <= kLast; ++frame) sample(sequence.get(), pan.at(frame), settings_for(frame, reconstruction, components));
  Pictures pictures;
  for (int32_t frame = 0; frame <= kLast; ++frame) {
    const auto task = sequence->deliver(frame, nullptr);
    run(task.get());
    pictures.combined.push_back(read(*task, GRADUS_PASS_COMBINED, 4));
    if (components == nullptr) continue;
    std::vector<float> sum(3 * kSide * kSide), part(sum);
    pictures.light.clear();
    for (const ComponentPlanes& planes : task->frame()->components) {
      task->read_component(planes.name, GRADUS_COMPONENT_COLOR, part.data());
      double light = 0.0;
      for (size_t i = 0; i < sum.size(); ++i) light += part[i];
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
      pictures.light.push_back(light);
    }
    pictures.sums.push_back(std::move(sum));
  }
  return pictures;
}

class SequenceComponents : public testing::TestWithParam<uint32_t> {};

TEST_P(SequenceComponents, AddUpToEveryFrame) {
  const Pictures pictures = rendered(GetParam(), "");
  EXPECT_GE(std::count_if(pictures.light.begin(), pictures.light.end(), [](double light) { return light > 1.0; }), 3);
  for (size_t frame = 0; frame <= size_t(kLast); ++frame) {
    const std::vector<float>&sum = pictures.sums[frame], &rgba = pictures.combined[frame];
    for (size_t i = 0; i < sum.size(); ++i) ASSERT_NEAR(sum[i], rgba[i / 3 * 4 + i % 3], 1e-5f * (std::fabs(sum[i]) + 1.0f)) << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(Reconstructions, SequenceComponents,
                         testing::Values(uint32_t{GRADUS_RECONSTRUCTION_L2}, uint32_t{GRADUS_RECONSTRUCTION_WEIGHTED},
                                         uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED}));

// The weights of L2 over time are the same for all.
TEST(ComponentsOfSequences, OfL2AddUpToThePicturesOfOne) {
  const Pictures many = rendered(GRADUS_RECONSTRUCTION_L2, ""), one = rendered(GRADUS_RECONSTRUCTION_L2, nullptr);
  for (size_t frame = 0; frame <= size_t(kLast); ++frame) {
    const std::vector<float>&a = many.combined[frame], &b = one.combined[frame];
    const float scale = *std::max_element(b.begin(), b.end());
    for (size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-4f * scale) << frame;
  }
}

}  // namespace
}  // namespace gradus
