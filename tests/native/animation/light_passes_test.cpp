// Light passes of animations add up to pictures that are reconstructed over windows of frames.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "animation/sequence_fixture.h"
#include "schema/pass_table.h"
#include "support/light_sum.h"

namespace gradus::light_passes_test {
namespace {

using namespace test;

constexpr int32_t kLast = 3;

GradusSettings settings_for(int32_t frame, uint32_t reconstruction) {
  GradusSettings settings = settings_of(frame);
  settings.reconstruction = reconstruction;
  settings.passes |= schema::needed_passes(schema::light_passes());
  return settings;
}

class SequenceLightPasses : public testing::TestWithParam<uint32_t> {};

TEST_P(SequenceLightPasses, AddUpInEveryFrame) {
  Pan pan(1.0f, Scenario::Glass);
  const auto sequence = make_sequence(0, kLast);
  for (int32_t frame = 0; frame <= kLast; ++frame)
    sample(sequence.get(), pan.at(frame), settings_for(frame, GetParam()));
  for (int32_t frame = 0; frame <= kLast; ++frame) {
    const auto task = delivered(sequence.get(), frame);
    expect_light_to_add_up([&](uint32_t pass) { return read(*task, pass, 3); }, read(*task, GRADUS_PASS_COMBINED, 4));
  }
}

INSTANTIATE_TEST_SUITE_P(Reconstructions, SequenceLightPasses,
                         testing::Values(uint32_t{GRADUS_RECONSTRUCTION_L2}, uint32_t{GRADUS_RECONSTRUCTION_L1},
                                         uint32_t{GRADUS_RECONSTRUCTION_REGULARIZED}));

// Returns the sum of all squared differences but the largest twentieth. Those at edges are quotients of small numbers.
double trimmed_distance(const std::vector<float>& a, const std::vector<float>& b) {
  std::vector<double> squares(a.size());
  for (size_t i = 0; i < a.size(); ++i) squares[i] = std::pow(double(a[i]) - double(b[i]), 2);
  std::sort(squares.begin(), squares.end());
  return std::accumulate(squares.begin(), squares.end() - ptrdiff_t(squares.size() / 20), 0.0);
}

// Light passes have the samples of all frames that the picture has.
TEST(JoinedLightPasses, HaveTheSamplesOfAllFrames) {
  constexpr int32_t kMiddle = 4;
  const auto light = [](int32_t first, int32_t last, uint32_t seed) {
    Pan pan(1.0f, Scenario::Glass);
    const auto sequence = make_sequence(first, last);
    for (int32_t frame = first; frame <= last; ++frame) {
      GradusSettings settings = settings_for(frame, GRADUS_RECONSTRUCTION_REGULARIZED);
      settings.seed = seed;
      sample(sequence.get(), pan.at(frame), settings);
    }
    return read(*delivered(sequence.get(), kMiddle), GRADUS_PASS_DIFFUSE_DIRECT, 3);
  };
  const double of_one = trimmed_distance(light(kMiddle, kMiddle, 1), light(kMiddle, kMiddle, 2)),
               of_nine = trimmed_distance(light(0, 8, 1), light(0, 8, 2));
  std::printf("  variance %.3f of that of one frame\n", of_nine / of_one);
  EXPECT_LT(of_nine, 0.6 * of_one);
}

}  // namespace
}  // namespace gradus::light_passes_test
