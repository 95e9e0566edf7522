// Animations with a denoiser, by a stand-in that adds the guides to what it is given: it reads the samples of all
// frames that are joined.
#include "sequence_fixture.h"

namespace gradus::test::denoised_sequence_test {
namespace {

const char* const kFake = GRADUS_BINARY_DIR "/tests/libfake_oidn.so";

GradusSettings denoised(int32_t frame, uint32_t samples, uint32_t denoiser = GRADUS_DENOISER_OIDN) {
  GradusSettings settings = settings_of(frame, samples);
  settings.reconstruction = GRADUS_RECONSTRUCTION_REGULARIZED;
  settings.integrator = GRADUS_INTEGRATOR_AUTO;
  settings.denoiser = denoiser;
  settings.passes |= uint64_t{1} << GRADUS_PASS_ERROR;
  return settings;
}

struct Picture {
  std::vector<float> combined, error;
  nlohmann::json stats;
};

// Renders `count` frames before which the camera moves by a pixel each, and returns the middle one, which is the same
// for all counts.
Picture middle_of(int count, uint32_t samples, uint32_t denoiser = GRADUS_DENOISER_OIDN, uint64_t seed = 1) {
  constexpr int32_t kMiddle = 4;
  const int32_t first = kMiddle - count / 2, last = first + count - 1;
  GradusDeviceSettings device{};
  device.struct_size = sizeof(device);
  device.threads = 2;
  device.denoiser_path = kFake;
  const auto sequence = std::make_shared<animation::Sequence>(std::make_shared<scene::Device>(device),
                                                              animation::SequenceSettings{first, last, 1, {}, ""});
  Pan pan(1.0f);
  for (int32_t frame = first; frame <= last; ++frame) {
    GradusSettings settings = denoised(frame, samples, denoiser);
    settings.seed = uint32_t(seed);
    run(sequence->sample(pan.at(frame), settings).get());
  }
  const GradusSettings settings = denoised(kMiddle, samples, denoiser);
  const auto task = sequence->deliver(kMiddle, &settings);
  run(task.get());
  return {read(*task, GRADUS_PASS_COMBINED, 4), read(*task, GRADUS_PASS_ERROR, 1),
          nlohmann::json::parse(task->stats())};
}

// The variance of what the network reads goes with the number of frames. Pixels that the pan shows in few frames, and
// the greater weight of the network, leave more than a ninth.
TEST(DenoisedSequence, TheNetworkReadsTheSamplesOfAllFrames) {
  const auto variance = [](int count) {
    return squared_distance(middle_of(count, 4, GRADUS_DENOISER_OIDN, 1).combined,
                            middle_of(count, 4, GRADUS_DENOISER_OIDN, 2).combined);
  };
  const double of_one = variance(1), of_nine = variance(9);
  std::printf("  variance %.3f of that of one frame\n", of_nine / of_one);
  EXPECT_GT(of_one, 0.0);
  EXPECT_LT(of_nine, 0.5 * of_one);
}

TEST(DenoisedSequence, TheErrorIsScaledByWhatJoinedFramesLeave) {
  const std::vector<float> plain = middle_of(3, 4, GRADUS_DENOISER_NONE).error, error = middle_of(3, 4).error;
  for (size_t i = 0; i < plain.size(); ++i) ASSERT_NEAR(error[i], 0.45f * plain[i], 1e-5f * plain[i]) << i;
}

// Regression: AUTO counted the samples of one frame, and left the denoiser out below 8.
TEST(DenoisedSequence, TheAutomaticOneCountsTheSamplesOfJoinedFrames) {
  const nlohmann::json nine = middle_of(9, 2, GRADUS_DENOISER_AUTO).stats,
                       one = middle_of(1, 2, GRADUS_DENOISER_AUTO).stats;
  EXPECT_EQ(nine["denoiser"], "Open Image Denoise 2.7.5");
  EXPECT_EQ(nine["plan"]["chosen"]["denoiser Open Image Denoise 2.7.5"], "automatic: a denoiser is available");
  EXPECT_TRUE(one["denoiser"].is_null());
  EXPECT_NE(one["plan"]["skipped"]["denoiser"].get<std::string>().find("below 8 samples"), std::string::npos);
}

}  // namespace
}  // namespace gradus::test::denoised_sequence_test
