// Light passes of animations add up to pictures that are reconstructed over windows of frames.
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

}  // namespace
}  // namespace gradus::light_passes_test
